//! Small recordings made byte by byte, as the formats' documents say, not with this crate's writers.

/// A message of a topic.
pub struct Message {
    pub topic: &'static str,
    pub kind: &'static str,
    pub data: Vec<u8>,
}

/// Writes fields as ROS 1 or CDR has them.
struct Fields {
    bytes: Vec<u8>,
    cdr: bool,
}

impl Fields {
    fn new(cdr: bool) -> Self {
        let bytes = if cdr { vec![0, 1, 0, 0] } else { Vec::new() };
        Self { bytes, cdr }
    }

    fn put<const N: usize>(mut self, number: [u8; N]) -> Self {
        while self.cdr && self.bytes.len() % N != 4 % N {
            self.bytes.push(0);
        }
        self.bytes.extend(number);
        self
    }

    fn text(self, text: &str) -> Self {
        let zero = usize::from(self.cdr);
        let mut fields = self.put(((text.len() + zero) as u32).to_le_bytes());
        fields.bytes.extend(text.as_bytes());
        fields.bytes.extend(vec![0; zero]);
        fields
    }

    fn header(self, stamp_s: u32, frame: &str) -> Self {
        let fields = if self.cdr {
            self
        } else {
            self.put(7_u32.to_le_bytes())
        };
        fields
            .put(stamp_s.to_le_bytes())
            .put(500_000_000_u32.to_le_bytes())
            .text(frame)
    }
}

/// The angles of a scan.
#[derive(Clone, Copy)]
pub struct Angles {
    pub min_rad: f32,
    pub step_rad: f32,
}

pub const AHEAD: Angles = Angles {
    min_rad: -0.5,
    step_rad: 0.25,
};

pub fn laser_scan(cdr: bool, stamp_s: u32, angles: Angles, ranges: &[f32]) -> Vec<u8> {
    let max_rad = angles.min_rad + angles.step_rad * (ranges.len() as f32 - 1.0);
    let mut fields = Fields::new(cdr).header(stamp_s, "laser");
    for number in [angles.min_rad, max_rad, angles.step_rad, 0.0, 0.1, 0.1, 30.0] {
        fields = fields.put(number.to_le_bytes());
    }
    fields = fields.put((ranges.len() as u32).to_le_bytes());
    for range in ranges {
        fields = fields.put(range.to_le_bytes());
    }
    fields.put(0_u32.to_le_bytes()).bytes
}

pub fn multi_echo(echoes: &[&[f32]]) -> Vec<u8> {
    let mut fields = Fields::new(true).header(100, "laser");
    for number in [-0.5_f32, 0.5, 0.25, 0.0, 0.1, 0.1, 30.0] {
        fields = fields.put(number.to_le_bytes());
    }
    fields = fields.put((echoes.len() as u32).to_le_bytes());
    for beam in echoes {
        fields = fields.put((beam.len() as u32).to_le_bytes());
        for echo in *beam {
            fields = fields.put(echo.to_le_bytes());
        }
    }
    fields.put(0_u32.to_le_bytes()).bytes
}

fn numbers(mut fields: Fields, numbers: &[f64]) -> Fields {
    for number in numbers {
        fields = fields.put(number.to_le_bytes());
    }
    fields
}

/// A transform of `laser` on `base`: place, quaternion x y z w.
pub fn transform(cdr: bool, place_m: [f64; 3], quaternion: [f64; 4]) -> Vec<u8> {
    let fields = Fields::new(cdr)
        .put(1_u32.to_le_bytes())
        .header(0, "base")
        .text("laser");
    numbers(numbers(fields, &place_m), &quaternion).bytes
}

pub fn odometry(cdr: bool, stamp_s: u32, x_m: f64) -> Vec<u8> {
    let fields = Fields::new(cdr).header(stamp_s, "odom").text("base");
    numbers(fields, &[x_m, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]).bytes
}

fn bag_record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let mut head = Vec::new();
    for (name, value) in fields {
        head.extend((name.len() as u32 + 1 + value.len() as u32).to_le_bytes());
        head.extend([name.as_bytes(), b"=", value].concat());
    }
    let mut record = (head.len() as u32).to_le_bytes().to_vec();
    record.extend(head);
    record.extend((data.len() as u32).to_le_bytes());
    record.extend(data);
    record
}

/// How the chunks of a bag are packed.
pub type Pack = (&'static str, fn(&[u8]) -> Vec<u8>);

/// A ROS 1 bag with one chunk for each of `chunks`, an index behind each that claims `index_bytes` an entry, and no
/// index at the end.
pub fn bag(chunks: &[Vec<Message>], (compression, pack): Pack, index_bytes: u32) -> Vec<u8> {
    let mut file = b"#ROSBAG V2.0\n".to_vec();
    file.extend(bag_record(&[("op", &[3]), ("index_pos", &[0; 8])], &[b' '; 32]));
    let mut topics: Vec<&str> = Vec::new();
    for messages in chunks {
        let mut chunk = Vec::new();
        for message in messages {
            let known = topics.iter().position(|t| *t == message.topic);
            let id = known.unwrap_or_else(|| {
                topics.push(message.topic);
                topics.len() - 1
            });
            let id = (id as u32).to_le_bytes();
            if known.is_none() {
                let inner = bag_record(
                    &[
                        ("topic", message.topic.as_bytes()),
                        ("type", message.kind.as_bytes()),
                    ],
                    &[],
                );
                let inner = &inner[4..inner.len() - 4];
                let head: &[(&str, &[u8])] =
                    &[("op", &[7]), ("conn", &id), ("topic", message.topic.as_bytes())];
                chunk.extend(bag_record(head, inner));
            }
            chunk.extend(bag_record(
                &[("op", &[2]), ("conn", &id), ("time", &[9; 8])],
                &message.data,
            ));
        }
        let size = (chunk.len() as u32).to_le_bytes();
        let head: &[(&str, &[u8])] = &[
            ("op", &[5]),
            ("compression", compression.as_bytes()),
            ("size", &size),
        ];
        file.extend(bag_record(head, &pack(&chunk)));
        let count = messages.len() as u32;
        let head = bag_record(
            &[
                ("op", &[4]),
                ("ver", &[1, 0, 0, 0]),
                ("count", &count.to_le_bytes()),
            ],
            &[],
        );
        file.extend(&head[..head.len() - 4]);
        file.extend((count * index_bytes).to_le_bytes());
        file.extend(vec![1; 12 * messages.len()]);
    }
    file
}

/// An MCAP file without chunks, with its footer.
pub fn mcap(messages: &[Message]) -> Vec<u8> {
    let mut file = b"\x89MCAP0\r\n".to_vec();
    let mut record = |opcode: u8, body: &[u8]| {
        file.push(opcode);
        file.extend((body.len() as u64).to_le_bytes());
        file.extend(body);
    };
    let text = |t: &str| [&(t.len() as u32).to_le_bytes()[..], t.as_bytes()].concat();
    let mut topics: Vec<&str> = Vec::new();
    for message in messages {
        let known = topics.iter().position(|t| *t == message.topic);
        let id = known.unwrap_or(topics.len()) as u16;
        if known.is_none() {
            topics.push(message.topic);
            let schema = [
                &(id + 1).to_le_bytes()[..],
                &text(message.kind),
                &text("ros2msg"),
                &text(""),
            ]
            .concat();
            record(3, &schema);
            let ids = [id.to_le_bytes(), (id + 1).to_le_bytes()].concat();
            record(
                4,
                &[&ids[..], &text(message.topic), &text("cdr"), &text("")].concat(),
            );
        }
        record(
            5,
            &[&id.to_le_bytes()[..], &[0; 4], &[0; 16], &message.data].concat(),
        );
    }
    record(0x0f, &[0; 4]);
    record(2, &[0; 20]);
    file.extend(b"\x89MCAP0\r\n");
    file
}

/// A rosbag2 database.
pub fn db3(path: &std::path::Path, messages: &[Message]) -> rusqlite::Result<()> {
    let database = rusqlite::Connection::open(path)?;
    database.execute_batch(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                             serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
         CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
                               data BLOB NOT NULL);",
    )?;
    let mut topics: Vec<&str> = Vec::new();
    for message in messages {
        if !topics.contains(&message.topic) {
            topics.push(message.topic);
            database.execute(
                "INSERT INTO topics VALUES(?1, ?2, ?3, 'cdr', '')",
                (topics.len() as i64, message.topic, message.kind),
            )?;
        }
        let topic = topics
            .iter()
            .position(|t| *t == message.topic)
            .map_or(0, |k| k + 1);
        database.execute(
            "INSERT INTO messages(topic_id, timestamp, data) VALUES(?1, 100, ?2)",
            (topic as i64, &message.data),
        )?;
    }
    Ok(())
}

/// A `CObservation2DRangeScan` of version 7.
pub fn rawlog_scan(right_to_left: bool, quaternion_rxyz: [f64; 4], ranges: &[f32], valid: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x97CObservation2DRangeScan\x07".to_vec();
    bytes.extend(1.0_f32.to_le_bytes());
    bytes.push(u8::from(right_to_left));
    bytes.extend(30.0_f32.to_le_bytes());
    bytes.extend(b"\x87CPose3D\x02");
    for number in [0.5, 0.0, 0.2].iter().chain(&quaternion_rxyz) {
        bytes.extend(number.to_le_bytes());
    }
    bytes.push(0x88);
    bytes.extend((ranges.len() as u32).to_le_bytes());
    for range in ranges {
        bytes.extend(range.to_le_bytes());
    }
    bytes.extend(valid);
    bytes.extend(0.01_f32.to_le_bytes());
    bytes.extend((116_444_736_000_000_000_i64 + 12_345_000_000).to_le_bytes());
    bytes.extend(0.01_f32.to_le_bytes());
    bytes.extend(4_u32.to_le_bytes());
    bytes.extend(b"SICK");
    bytes.extend(0.0_f64.to_le_bytes());
    bytes.extend([0, 0x88]);
    bytes
}

/// A step of odometry.
pub fn rawlog_step(x_m: f64) -> Vec<u8> {
    let mut bytes = b"\x96CActionRobotMovement2D\x06\0\0\0\0\x87CPose2D\x01".to_vec();
    for number in [x_m, 0.0, 0.0] {
        bytes.extend(f64::to_le_bytes(number));
    }
    bytes.extend([0x88, 0x88]);
    bytes
}

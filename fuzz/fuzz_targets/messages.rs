#![no_main]

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::read;

/// Topics, types and encodings; every message of the input goes to one of them.
const CHANNELS: &[(&str, &str, &str)] = &[
    ("/scan", "sensor_msgs/msg/LaserScan", "cdr"),
    ("/echoes", "sensor_msgs/msg/MultiEchoLaserScan", "cdr"),
    ("/tf_static", "tf2_msgs/msg/TFMessage", "cdr"),
    ("/tf", "tf2_msgs/msg/TFMessage", "cdr"),
    ("/odom", "nav_msgs/msg/Odometry", "cdr"),
    ("/scan1", "sensor_msgs/LaserScan", "ros1"),
    ("/tf_static", "tf/tfMessage", "ros1"),
    ("/odom1", "nav_msgs/Odometry", "ros1"),
];

/// The file before its first message: magic, header, channels.
static START: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut file = b"\x89MCAP0\r\n".to_vec();
    record(&mut file, 1, &[texts(&["ros2"]), texts(&["fuzz"])].concat());
    for (id, (topic, kind, encoding)) in (1_u16..).zip(CHANNELS) {
        let mut schema = id.to_le_bytes().to_vec();
        schema.extend(texts(&[kind, "ros2msg"]));
        schema.extend(0_u32.to_le_bytes());
        record(&mut file, 3, &schema);
        let mut channel = [id.to_le_bytes(), id.to_le_bytes()].concat();
        channel.extend(texts(&[topic, encoding]));
        channel.extend(0_u32.to_le_bytes());
        record(&mut file, 4, &channel);
    }
    file
});

// Input: channel, length (two bytes), message, again and again. It is put into an MCAP file without chunks.
fuzz_target!(|data: &[u8]| {
    let mut file = START.clone();
    let mut rest = data;
    while let [channel, low, high, after @ ..] = rest {
        let length = usize::from(u16::from_le_bytes([*low, *high])).min(after.len());
        let (message, behind) = after.split_at(length);
        let id = u16::from(*channel) % CHANNELS.len() as u16 + 1;
        let mut body = id.to_le_bytes().to_vec();
        body.extend([0; 20]);
        body.extend(message);
        record(&mut file, 5, &body);
        rest = behind;
    }
    read(file);
});

fn record(file: &mut Vec<u8>, opcode: u8, body: &[u8]) {
    file.push(opcode);
    file.extend((body.len() as u64).to_le_bytes());
    file.extend(body);
}

fn texts(texts: &[&str]) -> Vec<u8> {
    texts
        .iter()
        .flat_map(|t| [&(t.len() as u32).to_le_bytes()[..], t.as_bytes()].concat())
        .collect()
}

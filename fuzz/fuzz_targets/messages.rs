#![no_main]

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

// Input: channel, length (two bytes), message, again and again. It is put into an MCAP file without chunks; a channel
// is told before its first message.
fuzz_target!(|data: &[u8]| {
    let mut file = b"\x89MCAP0\r\n".to_vec();
    let mut told = [false; CHANNELS.len()];
    let mut rest = data;
    while let [channel, low, high, after @ ..] = rest {
        let length = usize::from(u16::from_le_bytes([*low, *high])).min(after.len());
        let (message, behind) = after.split_at(length);
        let id = usize::from(*channel) % CHANNELS.len();
        if !std::mem::replace(&mut told[id], true) {
            tell(&mut file, id);
        }
        let mut body = (id as u16 + 1).to_le_bytes().to_vec();
        body.extend([0; 20]);
        body.extend(message);
        record(&mut file, 5, &body);
        rest = behind;
    }
    read(file);
});

/// Writes the schema and the channel with the number `id`.
fn tell(file: &mut Vec<u8>, id: usize) {
    let (topic, kind, encoding) = CHANNELS[id];
    let id = (id as u16 + 1).to_le_bytes();
    let mut schema = id.to_vec();
    schema.extend(texts(&[kind, "ros2msg"]));
    schema.extend(0_u32.to_le_bytes());
    record(file, 3, &schema);
    let mut channel = [id, id].concat();
    channel.extend(texts(&[topic, encoding]));
    channel.extend(0_u32.to_le_bytes());
    record(file, 4, &channel);
}

fn record(file: &mut Vec<u8>, opcode: u8, body: &[u8]) {
    file.push(opcode);
    file.extend((body.len() as u64).to_le_bytes());
    file.extend(body);
}

fn texts(texts: &[&str]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for text in texts {
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
    }
    bytes
}

//! Plain CDR, little endian: numbers at multiples of their size, texts with a zero byte at their end.

/// The bytes of a message, field after field.
pub(super) struct Cdr {
    bytes: Vec<u8>,
}

/// Representation: plain CDR, little endian, no options.
const HEAD: [u8; 4] = [0, 1, 0, 0];

impl Cdr {
    pub fn new() -> Self {
        Self { bytes: HEAD.to_vec() }
    }

    fn number<const N: usize>(&mut self, number: [u8; N]) {
        while !(self.bytes.len() - HEAD.len()).is_multiple_of(N) {
            self.bytes.push(0);
        }
        self.bytes.extend_from_slice(&number);
    }

    pub fn u32(&mut self, value: u32) {
        self.number(value.to_le_bytes());
    }

    pub fn f32(&mut self, value: f64) {
        self.number((value as f32).to_le_bytes());
    }

    pub fn f64(&mut self, value: f64) {
        self.number(value.to_le_bytes());
    }

    pub fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
    }

    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

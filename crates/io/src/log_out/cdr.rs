//! CDR, little endian, as ROS 2 writes messages (OMG DDS-XTypes, XCDR1): numbers aligned to their size, counted
//! from behind the four bytes of the head; strings with their length and a zero; sequences with their count.

/// A message being written.
pub(crate) struct Cdr(Vec<u8>);

/// What says "CDR, little endian".
const HEAD: [u8; 4] = [0, 1, 0, 0];

impl Cdr {
    pub fn new() -> Self {
        Self(HEAD.to_vec())
    }

    pub fn bytes(self) -> Vec<u8> {
        self.0
    }

    pub fn u8(&mut self, value: u8) {
        self.0.push(value);
    }

    pub fn bool(&mut self, value: bool) {
        self.u8(value.into());
    }

    pub fn u32(&mut self, value: u32) {
        self.aligned(&value.to_le_bytes());
    }

    pub fn i32(&mut self, value: i32) {
        self.aligned(&value.to_le_bytes());
    }

    pub fn f32(&mut self, value: f32) {
        self.aligned(&value.to_le_bytes());
    }

    pub fn f64(&mut self, value: f64) {
        self.aligned(&value.to_le_bytes());
    }

    pub fn f64s<const N: usize>(&mut self, values: [f64; N]) {
        values.into_iter().for_each(|value| self.f64(value));
    }

    pub fn text(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.0.extend_from_slice(text.as_bytes());
        self.u8(0);
    }

    /// How many items of a sequence follow.
    pub fn count(&mut self, count: usize) {
        self.u32(u32::try_from(count).unwrap_or(u32::MAX));
    }

    fn aligned(&mut self, bytes: &[u8]) {
        while !(self.0.len() - HEAD.len()).is_multiple_of(bytes.len()) {
            self.0.push(0);
        }
        self.0.extend_from_slice(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_at_multiples_of_their_size() {
        let mut cdr = Cdr::new();
        cdr.u8(7);
        cdr.f64(1.0);
        cdr.text("ab");
        cdr.u32(5);
        let expected: [&[u8]; 5] = [
            &[0, 1, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0],
            &1.0_f64.to_le_bytes(),
            &[3, 0, 0, 0, b'a', b'b', 0],
            &[0],
            &[5, 0, 0, 0],
        ];
        assert_eq!(cdr.bytes(), expected.concat());
    }
}

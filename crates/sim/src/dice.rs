//! Random numbers: the same from the same seed on every platform.
//!
//! xoshiro256++ (Blackman and Vigna, "Scrambled linear pseudorandom number generators", 2021), seeded through
//! splitmix64. Sine, cosine and logarithm come from `libm` instead of the platform's own library, whose last
//! bit differs from system to system.

use std::f64::consts::TAU;

use polymapper_core::geometry::Point;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// What the numbers are for. Each purpose has its own row of numbers, so that more people do not change the
/// noise, and another scanner does not change the floor plan.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Purpose {
    Plan = 1,
    People = 2,
    Scanner = 3,
    Odometry = 4,
}

/// A source of random numbers.
pub(crate) struct Dice(Xoshiro256PlusPlus);

impl Dice {
    pub(crate) fn new(seed: u64, purpose: Purpose) -> Self {
        // An odd factor maps different seeds to different states; splitmix64 then stirs.
        let mixed = seed
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .wrapping_add((purpose as u64) << 56);
        Self(Xoshiro256PlusPlus::seed_from_u64(mixed))
    }

    /// Evenly spread over 0..1, 1 excluded (53 bits).
    pub(crate) fn share(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (0.5_f64).powi(53)
    }

    /// Evenly spread between two numbers.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// Evenly spread between two lengths, on whole centimetres: builders work with a tape measure.
    pub(crate) fn built_m(&mut self, low_m: f64, high_m: f64) -> f64 {
        (self.between(low_m, high_m) * 100.0).round() / 100.0
    }

    /// One of 0..count; 0 for a count of 0.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.share() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// True with the given probability.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.share() < probability
    }

    /// Standard normal (Box and Muller 1958). One of the pair is thrown away, so that every call takes two numbers.
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(1.0 - self.share())).sqrt();
        radius * libm::cos(TAU * self.share())
    }

    /// Exponentially spread with the given mean.
    pub(crate) fn exponential(&mut self, mean: f64) -> f64 {
        -mean * libm::log(1.0 - self.share())
    }

    /// A point of the box between two corners.
    pub(crate) fn point(&mut self, low: Point, high: Point) -> Point {
        let x = self.between(low.x, high.x);
        Point::new(x, self.between(low.y, high.y))
    }
}

/// The unit vector in direction `bearing_rad`, to the same bits on every platform.
pub(crate) fn direction(bearing_rad: f64) -> Point {
    Point::new(libm::cos(bearing_rad), libm::sin(bearing_rad))
}

/// The direction of a vector, radians, to the same bits on every platform.
pub(crate) fn bearing_rad(v: Point) -> f64 {
    libm::atan2(v.y, v.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_have_mean_zero_and_deviation_one() {
        let mut dice = Dice::new(7, Purpose::Scanner);
        let n = 40_000;
        let (mut sum, mut squares, mut beyond_two) = (0.0, 0.0, 0);
        for _ in 0..n {
            let x = dice.normal();
            sum += x;
            squares += x * x;
            beyond_two += usize::from(x.abs() > 2.0);
        }
        let n = f64::from(n);
        assert!((sum / n).abs() < 0.02);
        assert!((squares / n - 1.0).abs() < 0.03);
        assert!((beyond_two as f64 / n - 0.0455).abs() < 0.005);
    }

    /// The first numbers, written down: another platform, or a new version of a crate, must give the same.
    #[test]
    fn the_numbers_of_a_seed_never_change() {
        let mut dice = Dice::new(1, Purpose::Plan);
        let bits = [dice.share().to_bits(), dice.normal().to_bits()];
        assert_eq!(bits, [0x3fec_4b09_9fce_7ab9, 0xbfe7_fbfc_8f53_c0b8]);
    }
}

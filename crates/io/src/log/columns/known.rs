//! Layouts of files that people have and that do not say what their columns are.
//!
//! Asked in order; the first that fits the first lines of a file reads it. A file is recognised by a keyword, or by
//! having exactly these many numbers in every line.

/// A known kind of file.
pub(super) struct Known {
    /// What it is, for the user.
    pub name: &'static str,
    /// Its layout.
    pub layout: &'static str,
}

pub(super) const KNOWN: &[Known] = &[
    Known {
        // Pairs of bearing and range, bearings uneven and falling; seconds and nanoseconds.
        name: "LASERSCAN lines",
        layout: "=LASERSCAN skip stamp_s stamp_ns count bearing_deg+range_m* x_m y_m theta_rad skip*",
    },
    Known {
        // A SICK LMS of 180°.
        name: "Odometry and Laser lines",
        layout: "=Laser count range_m* first_deg=-90 width_deg=180 pose=Odometry",
    },
    Known {
        // tinySLAM's test files: 24 numbers of the robot, two of them encoder counts, then steps 44 to 725 of a
        // URG-04LX, of 1024 to the turn, the 384th ahead.
        name: "URG-04LX with encoders",
        layout: "stamp_us skip*23 range_mm*682 skip* first_deg=-119.53125 step_deg=0.3515625",
    },
    Known {
        // Encoder counts left and right, milliseconds, a reading for each degree.
        name: "RPLIDAR with encoders",
        layout: "skip*2 stamp_ms range_mm*360 first_deg=0 step_deg=-1",
    },
];

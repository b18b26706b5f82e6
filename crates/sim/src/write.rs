//! Logs and truth as files.
//!
//! CARMEN log: `FLASER n r1..rn x y theta odom_x odom_y odom_theta stamp host logger_stamp` for the SICK (181 beams
//! stand for 1° from −90° to 90°), and `ROBOTLASER1`, which holds the geometry, for the others. The poses in it are
//! the drifting odometry, or zero; never the truth.
//!
//! Truth: one JSON object, lengths in metres, angles in radians, world frame:
//! `{"format":"polymapper-truth","version":1,"plan":"office","seed":1,"stamps_s":[..],"poses":[[x,y,theta],..],
//! "walls":[[[x,y],..],..],"seen":[[[x,y],[x,y]],..],"plants":[[x,y,radius],..],"people":[[[x,y],..],..]}`.
//! `poses` are laser poses, one a scan; `walls` closed polylines with free space on their left; `seen` the
//! stretches of them that returned a beam; `people` the places of everybody, one list a scan.

use std::io::{self, Write};

use polymapper_core::geometry::{Point, Pose};
use polymapper_core::scan::Scan;

use crate::scanner::ScannerKind;
use crate::simulate::SimLog;

impl SimLog {
    /// Writes the log in CARMEN's format (see the module's documentation).
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn write_carmen(&self, mut out: impl Write) -> io::Result<()> {
        let settings = &self.settings;
        writeln!(
            out,
            "# polymapper-sim: plan {} seed {} scanner {}, {} people; odometry {}",
            settings.plan,
            settings.seed,
            settings.scanner.kind,
            settings.people,
            if self.odometry.is_empty() {
                "none"
            } else {
                "simulated"
            },
        )?;
        for (k, (scan, &stamp_s)) in self.scans.iter().zip(&self.stamps_s).enumerate() {
            let odometry = self.odometry.get(k).copied().unwrap_or_default();
            match settings.scanner.kind {
                ScannerKind::Sick180 => self.write_flaser(&mut out, scan, odometry, stamp_s)?,
                ScannerKind::Hokuyo240 | ScannerKind::LowCost360 => {
                    self.write_robotlaser(&mut out, scan, odometry, stamp_s)?;
                }
            }
        }
        out.flush()
    }

    fn write_flaser(&self, out: &mut impl Write, scan: &Scan, odom: Pose, stamp_s: f64) -> io::Result<()> {
        write!(out, "FLASER {}", scan.ranges_m().len())?;
        self.write_ranges(out, scan)?;
        for _ in ["laser", "robot"] {
            write!(out, " {:.6} {:.6} {:.6}", odom.x, odom.y, odom.theta_rad)?;
        }
        writeln!(out, " {stamp_s:.6} sim {stamp_s:.6}")
    }

    /// `ROBOTLASER1 type start fov step max_range accuracy remission_mode n r1..rn n_remissions laser_x laser_y
    /// laser_theta robot_x robot_y robot_theta tv rv forward_safety side_safety turn_axis stamp host logger_stamp`.
    fn write_robotlaser(
        &self,
        out: &mut impl Write,
        scan: &Scan,
        odom: Pose,
        stamp_s: f64,
    ) -> io::Result<()> {
        let (geometry, scanner) = (&self.geometry, &self.settings.scanner);
        let beams = geometry.beams();
        write!(
            out,
            "ROBOTLASER1 0 {:.9} {:.9} {:.12} {:.3} {:.3} 0 {beams}",
            geometry.bearing_rad(0),
            geometry.step_rad() * beams.saturating_sub(1) as f64,
            geometry.step_rad(),
            scanner.max_range_m,
            scanner.noise_m,
        )?;
        self.write_ranges(out, scan)?;
        write!(out, " 0")?;
        for _ in ["laser", "robot"] {
            write!(out, " {:.6} {:.6} {:.6}", odom.x, odom.y, odom.theta_rad)?;
        }
        writeln!(out, " 0 0 0 0 0 {stamp_s:.6} sim {stamp_s:.6}")
    }

    fn write_ranges(&self, out: &mut impl Write, scan: &Scan) -> io::Result<()> {
        let scanner = &self.settings.scanner;
        let decimals = scanner.decimals();
        for &range_m in scan.ranges_m() {
            let logged_m = if range_m.is_nan() {
                scanner.no_return_m()
            } else {
                range_m
            };
            write!(out, " {logged_m:.decimals$}")?;
        }
        Ok(())
    }

    /// Writes the truth as JSON (see the module's documentation).
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn write_truth(&self, mut out: impl Write) -> io::Result<()> {
        write!(
            out,
            "{{\"format\":\"polymapper-truth\",\"version\":1,\"plan\":\"{}\",\"seed\":{},\n\"stamps_s\":",
            self.settings.plan, self.settings.seed
        )?;
        list(&mut out, &self.stamps_s, |out, stamp_s| {
            write!(out, "{stamp_s:.6}")
        })?;
        write!(out, ",\n\"poses\":")?;
        list(&mut out, &self.truth_poses, |out, p| {
            write!(out, "[{:.9},{:.9},{:.9}]", p.x, p.y, p.theta_rad)
        })?;
        write!(out, ",\n\"walls\":")?;
        list(&mut out, self.walls(), |out, wall| {
            list(out, wall.vertices(), point)
        })?;
        write!(out, ",\n\"seen\":")?;
        list(&mut out, &self.seen.stretches(), |out, s| {
            list(out, &[s.a, s.b], point)
        })?;
        write!(out, ",\n\"plants\":")?;
        list(&mut out, self.plan.plants(), |out, plant| {
            write!(
                out,
                "[{:.6},{:.6},{:.6}]",
                plant.centre.x, plant.centre.y, plant.radius_m
            )
        })?;
        write!(out, ",\n\"people\":")?;
        list(&mut out, &self.people, |out, there| list(out, there, point))?;
        writeln!(out, "}}")?;
        out.flush()
    }
}

/// A JSON list of what `item` writes.
fn list<W: Write, T>(
    out: &mut W,
    items: &[T],
    item: impl Fn(&mut W, &T) -> io::Result<()>,
) -> io::Result<()> {
    write!(out, "[")?;
    for (k, it) in items.iter().enumerate() {
        if k > 0 {
            write!(out, ",")?;
        }
        item(out, it)?;
    }
    write!(out, "]")
}

fn point<W: Write>(out: &mut W, p: &Point) -> io::Result<()> {
    write!(out, "[{:.6},{:.6}]", p.x, p.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Motion;
    use crate::plan::PlanKind;
    use crate::scanner::Scanner;
    use crate::simulate::{SimSettings, simulate};

    fn files(settings: &SimSettings) -> (SimLog, String, String) {
        let log = simulate(settings).unwrap();
        let (mut carmen, mut truth) = (Vec::new(), Vec::new());
        log.write_carmen(&mut carmen).unwrap();
        log.write_truth(&mut truth).unwrap();
        (
            log,
            String::from_utf8(carmen).unwrap(),
            String::from_utf8(truth).unwrap(),
        )
    }

    fn settings(kind: ScannerKind) -> SimSettings {
        SimSettings {
            scanner: Scanner::new(kind),
            motion: Motion {
                max_scans: 30,
                ..Motion::keyframes()
            },
            people: 2,
            ..SimSettings::new(PlanKind::Office, 1)
        }
    }

    fn numbers(words: &[&str]) -> Vec<f64> {
        words.iter().map(|w| w.parse().unwrap()).collect()
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes() {
        for kind in ScannerKind::ALL {
            let (_, carmen, truth) = files(&settings(kind));
            let (_, carmen_again, truth_again) = files(&settings(kind));
            assert!(carmen == carmen_again && truth == truth_again, "{kind}");
            let (_, other, _) = files(&SimSettings {
                seed: 2,
                ..settings(kind)
            });
            assert_ne!(carmen, other);
        }
    }

    /// Sums of whole files, written down: they are the same on every platform, and change only when a plan, a
    /// scanner, the order of the dice or what counts as no return is changed on purpose. (FNV-1a.)
    #[test]
    fn the_bytes_of_a_seed_are_known() {
        let sum = |text: &str| {
            text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |sum, byte| {
                (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            })
        };
        let (_, carmen, truth) = files(&settings(ScannerKind::LowCost360));
        let sums = [sum(&carmen), sum(&truth)];
        assert_eq!(sums, [0x749d_7b4f_b2f2_3b88, 0xbb34_fb16_c402_2414], "{sums:#x?}");
    }

    #[test]
    fn a_flaser_line_holds_the_scan_and_the_odometry() {
        let (log, carmen, _) = files(&settings(ScannerKind::Sick180));
        let lines: Vec<&str> = carmen.lines().filter(|l| !l.starts_with('#')).collect();
        assert_eq!(lines.len(), 30);
        for (k, line) in lines.iter().enumerate() {
            let words: Vec<&str> = line.split(' ').collect();
            assert_eq!(
                (words[0], words[1], words.len()),
                ("FLASER", "181", 2 + 181 + 6 + 3)
            );
            for (range, logged) in log.scans[k].ranges_m().iter().zip(numbers(&words[2..183])) {
                let same = logged.to_bits() == if range.is_nan() { 81.91_f64 } else { *range }.to_bits();
                assert!(same, "{range} {logged}");
            }
            let poses = numbers(&words[183..189]);
            assert!(
                (poses[0] - log.odometry[k].x).abs() < 1e-6
                    && (poses[5] - log.odometry[k].theta_rad).abs() < 1e-6
            );
            assert!((numbers(&words[189..190])[0] - log.stamps_s[k]).abs() < 1e-6);
        }
    }

    #[test]
    fn a_robotlaser_line_holds_the_geometry() {
        for (kind, beams) in [(ScannerKind::Hokuyo240, 682), (ScannerKind::LowCost360, 360)] {
            let (log, carmen, _) = files(&settings(kind));
            let line = carmen.lines().nth(1).unwrap();
            let words: Vec<&str> = line.split(' ').collect();
            assert_eq!(words[0], "ROBOTLASER1");
            assert_eq!(words.len(), 9 + beams + 1 + 11 + 3);
            let head = numbers(&words[1..9]);
            assert!((head[1] - log.geometry.bearing_rad(0)).abs() < 1e-8);
            assert!((head[1] + head[2] - log.geometry.bearing_rad(beams - 1)).abs() < 1e-8);
            assert!((head[3] * (beams - 1) as f64 - head[2]).abs() < 1e-8);
            for (range, logged) in log.scans[0].ranges_m().iter().zip(numbers(&words[9..9 + beams])) {
                assert!(range.is_nan() && logged == 0.0 || range.to_bits() == logged.to_bits());
            }
        }
    }

    /// Truth and log agree: points of the log, moved by poses read from the truth, lie on walls read from it.
    #[test]
    fn the_truth_file_explains_the_log() {
        let (log, _, truth) = files(&SimSettings {
            people: 0,
            ..settings(ScannerKind::Sick180)
        });
        let text_of = |key: &str| {
            let line = truth
                .lines()
                .find(|l| l.starts_with(&format!("\"{key}\":")))
                .unwrap();
            line[key.len() + 3..].trim_end_matches(',').to_owned()
        };
        let flat = |text: &str| -> Vec<f64> {
            text.split(['[', ']', ','])
                .filter(|w| !w.is_empty())
                .map(|w| w.parse().unwrap())
                .collect()
        };
        let poses = flat(&text_of("poses"));
        assert_eq!(poses.len(), 3 * log.scans.len());
        let walls: Vec<Vec<f64>> = text_of("walls").split("]],[[").map(flat).collect();
        assert_eq!(walls.len(), log.walls().len());
        let sides: Vec<polymapper_core::geometry::Segment> = walls
            .iter()
            .flat_map(|w| {
                let points: Vec<Point> = w.chunks(2).map(|c| Point::new(c[0], c[1])).collect();
                points
                    .windows(2)
                    .map(|p| polymapper_core::geometry::Segment::new(p[0], p[1]))
                    .collect::<Vec<_>>()
            })
            .collect();
        for (k, pose) in poses.chunks(3).enumerate() {
            let pose = Pose::new(pose[0], pose[1], pose[2]);
            for (_, point) in log.scans[k].points() {
                let point = pose * point;
                let off_m = sides
                    .iter()
                    .map(|s| s.distance(point))
                    .fold(f64::INFINITY, f64::min);
                assert!(off_m < 0.06, "{off_m} m from every wall with a noise of 1 cm");
            }
        }
    }
}

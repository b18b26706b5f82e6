//! Time by stage, on the wall clock and of the processor.

use std::time::{Duration, Instant};

use polymapper_io::out::StageTime;

/// Adds up the time of stages that take turns.
pub struct StageClock {
    stages: Vec<Stage>,
    running: Option<(usize, Reading)>,
}

struct Stage {
    name: &'static str,
    wall: Duration,
    cpu: Option<Duration>,
}

#[derive(Clone, Copy)]
struct Reading {
    wall: Instant,
    cpu: Option<Duration>,
}

impl Reading {
    fn now() -> Self {
        Self {
            wall: Instant::now(),
            cpu: cpu_time(),
        }
    }
}

/// Processor time of the whole process, all threads.
#[cfg(unix)]
fn cpu_time() -> Option<Duration> {
    use rustix::time::{ClockId, clock_gettime};
    Duration::try_from(clock_gettime(ClockId::ProcessCPUTime)).ok()
}

#[cfg(not(unix))]
fn cpu_time() -> Option<Duration> {
    None
}

impl StageClock {
    /// No stage runs. `stages` sets the order of the report.
    pub fn new(stages: &[&'static str]) -> Self {
        let stage = |&name| Stage {
            name,
            wall: Duration::ZERO,
            cpu: cpu_time().map(|_| Duration::ZERO),
        };
        Self {
            stages: stages.iter().map(stage).collect(),
            running: None,
        }
    }

    /// Ends the stage that runs and starts `name`, for the first time or again.
    pub fn enter(&mut self, name: &'static str) {
        let now = self.stop();
        let place = self
            .stages
            .iter()
            .position(|s| s.name == name)
            .unwrap_or_else(|| {
                self.stages.push(Stage {
                    name,
                    wall: Duration::ZERO,
                    cpu: now.cpu.map(|_| Duration::ZERO),
                });
                self.stages.len() - 1
            });
        self.running = Some((place, now));
    }

    fn stop(&mut self) -> Reading {
        let now = Reading::now();
        if let Some((place, since)) = self.running.take() {
            let stage = &mut self.stages[place];
            stage.wall += now.wall - since.wall;
            if let (Some(sum), Some(now), Some(since)) = (&mut stage.cpu, now.cpu, since.cpu) {
                *sum += now.saturating_sub(since);
            }
        }
        now
    }

    /// Ends the stage that runs and gives the time of all.
    pub fn times(&mut self) -> Vec<StageTime> {
        self.stop();
        let time = |stage: &Stage| StageTime {
            stage: stage.name.to_owned(),
            wall_s: micro(stage.wall),
            cpu_s: stage.cpu.map(micro),
        };
        self.stages.iter().map(time).collect()
    }
}

/// Seconds with six decimals.
fn micro(time: Duration) -> f64 {
    time.as_micros() as f64 / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_that_take_turns_add_up() {
        let mut clock = StageClock::new(&["read", "map"]);
        let start = Instant::now();
        for _ in 0..3 {
            clock.enter("map");
            std::thread::sleep(Duration::from_millis(5));
            clock.enter("read");
        }
        let times = clock.times();
        let whole_s = start.elapsed().as_secs_f64();
        assert_eq!(
            times.iter().map(|t| t.stage.as_str()).collect::<Vec<_>>(),
            ["read", "map"]
        );
        assert!(times[1].wall_s >= 0.015 && times[1].wall_s <= whole_s);
        assert!(times[0].wall_s + times[1].wall_s <= whole_s + 1e-5);
    }
}

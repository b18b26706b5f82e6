//! TUM: `time x y z qx qy qz qw` a placed scan, as `build` writes it.

use super::{ExportError, Place, Subject};
use crate::out::write_trajectory_tum;

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    subject.way(place)?;
    let rows = subject.trajectory.unwrap_or_default();
    place.write(0, |f| write_trajectory_tum(f, rows))
}

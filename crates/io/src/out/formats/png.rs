//! PNG: the picture that `build` draws, of this map.

use std::io::Write;

use super::{ExportError, Place, Subject};

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    let png = (subject.draw_png)().map_err(|source| place.failed(source))?;
    place.write(0, |f| f.write_all(&png))
}

//! `report.html`: the page, a light record and the figures of a build, in one file that can be mailed.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::page;

/// The file. `record` is packed as [`ReplayWriter::light`](crate::replay::ReplayWriter::light) does; `report` is what
/// the page shows in figures, as JSON.
#[must_use]
pub fn report_html(title: &str, record: &[u8], report: &serde_json::Value) -> String {
    // Nothing in JSON needs `<` outside of strings, and in strings it may be written so; `</script>` must not occur.
    let figures = report.to_string().replace('<', "\\u003c");
    let data = format!(
        "<script type=\"application/json\" id=\"report-data\">{figures}</script>\n\
         <script type=\"application/gzip\" id=\"record-data\">{}</script>",
        STANDARD.encode(record)
    );
    page::whole_html(title, &data)
}

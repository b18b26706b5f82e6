//! The page, held by the program: markup, style, and modules of plain JavaScript that are joined into one script.
//!
//! The modules import each other for the type checker and the linter. A report has to be one file, and a module in a
//! file cannot be imported from the same file; so they are put one after the other, in the order of [`MODULES`],
//! without their `import` and `export` words. The same script is served to the live page.

use std::sync::LazyLock;

/// The style sheet.
pub const STYLE: &str = concat!(
    include_str!("../page/style/colours.css"),
    include_str!("../page/style/base.css"),
    include_str!("../page/style/top.css"),
    include_str!("../page/style/map.css"),
    include_str!("../page/style/side.css"),
    include_str!("../page/style/layers.css"),
    include_str!("../page/style/time.css"),
    include_str!("../page/style/report.css"),
    include_str!("../page/style/dialog.css"),
    include_str!("../page/style/phone.css"),
);
/// The icon.
pub const ICON: &str = include_str!("../page/icon.svg");
const MARKUP: &str = include_str!("../page/index.html");

macro_rules! modules {
    ($($name:literal),* $(,)?) => {
        /// Name and text of every module; one that is imported stands before those that import it.
        pub const MODULES: &[(&str, &str)] = &[$(($name, include_str!(concat!("../page/src/", $name)))),*];
    };
}

modules![
    "dom.js",
    "pose.js",
    "format.js",
    "record.js",
    "history.js",
    "details.js",
    "colours.js",
    "camera.js",
    "surface.js",
    "known_walls.js",
    "draw_map.js",
    "draw_way.js",
    "draw_scan.js",
    "draw_match.js",
    "layers.js",
    "scene.js",
    "pick.js",
    "measure.js",
    "tooltip.js",
    "gestures.js",
    "player.js",
    "framing.js",
    "controls.js",
    "timeline.js",
    "panel.js",
    "source.js",
    "keys.js",
    "theme.js",
    "scale_bar.js",
    "report.js",
    "main.js",
];

static SCRIPT: LazyLock<String> = LazyLock::new(|| joined(MODULES));

/// The whole script.
#[must_use]
pub fn script() -> &'static str {
    &SCRIPT
}

/// The page that asks the server for its parts.
#[must_use]
pub fn live_html() -> &'static str {
    MARKUP
}

/// The page with everything in it; `data` goes before the script.
pub(crate) fn whole_html(title: &str, data: &str) -> String {
    let icon = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, ICON);
    MARKUP
        .replace(
            "<title>polymapper</title>",
            &format!("<title>{}</title>", escaped(title)),
        )
        .replace(
            "<link rel=\"stylesheet\" href=\"style.css\">",
            &format!("<style>\n{STYLE}</style>"),
        )
        .replace(
            "href=\"icon.svg\"",
            &format!("href=\"data:image/svg+xml;base64,{icon}\""),
        )
        .replace(
            "<script type=\"module\" src=\"app.js\"></script>",
            &format!("{data}\n<script type=\"module\">\n{}</script>", script()),
        )
}

/// Text for HTML.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

fn joined(modules: &[(&str, &str)]) -> String {
    let mut out = String::from("\"use strict\";\n");
    for (name, text) in modules {
        out.push_str(&format!("\n// {name}\n"));
        let mut in_import = false;
        for line in text.lines() {
            in_import |= line.starts_with("import ");
            if in_import {
                in_import = !line.ends_with(';');
                continue;
            }
            out.push_str(line.strip_prefix("export ").unwrap_or(line));
            out.push('\n');
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_stand_after_those_that_they_import() {
        for (k, (name, text)) in MODULES.iter().enumerate() {
            for line in text.lines().filter(|l| l.contains(" from \"./")) {
                let wanted = line
                    .rsplit_once("./")
                    .and_then(|(_, rest)| rest.split_once('"'))
                    .map(|(file, _)| file)
                    .unwrap();
                let before = MODULES[..k].iter().any(|(other, _)| *other == wanted);
                assert!(before, "{name} imports {wanted}, which does not stand before it");
            }
        }
    }

    #[test]
    fn a_report_is_one_file() {
        let html = whole_html("a <b>", "<script type=\"application/json\">{}</script>");
        for outside in [
            "src=\"",
            "href=\"style.css\"",
            "href=\"icon.svg\"",
            "\nimport ",
            "\nexport ",
        ] {
            assert!(!html.contains(outside), "{outside}");
        }
        assert!(html.contains("<title>a &lt;b&gt;</title>"));
        assert_eq!(html.matches("</script>").count(), 2);
    }

    #[test]
    fn words_that_a_report_replaces_are_in_the_markup() {
        for part in [
            "<title>polymapper</title>",
            "<link rel=\"stylesheet\" href=\"style.css\">",
            "href=\"icon.svg\"",
            "<script type=\"module\" src=\"app.js\"></script>",
        ] {
            assert_eq!(MARKUP.matches(part).count(), 1, "{part}");
        }
    }
}

//! Files that are there whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Why an output could not be written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// A file could not be made, written or put in its place.
    #[error("cannot write {name}")]
    File {
        /// Name of the file.
        name: String,
        /// What the system says.
        source: io::Error,
    },
    /// A folder could not be made, or nothing can be written into it.
    #[error("cannot write into the folder {name}")]
    Folder {
        /// Name of the folder.
        name: String,
        /// What the system says.
        source: io::Error,
    },
}

/// A file that is written under another name and takes its own name when it is whole.
///
/// An interrupted run, a full disk or an error on the way leaves what stood there before.
#[derive(Debug)]
pub struct AtomicFile {
    place: PathBuf,
    draft: PathBuf,
    writer: Option<BufWriter<File>>,
}

impl AtomicFile {
    /// Begins the file that will stand at `place`.
    ///
    /// # Errors
    /// The draft beside it cannot be made.
    pub fn create(place: &Path) -> Result<Self, OutputError> {
        let draft = draft_of(place);
        let file = File::create(&draft).map_err(|source| file_error(place, source))?;
        Ok(Self {
            place: place.to_owned(),
            draft,
            writer: Some(BufWriter::new(file)),
        })
    }

    /// Puts the whole file in its place.
    ///
    /// # Errors
    /// The rest cannot be written, or the name cannot be taken.
    pub fn finish(mut self) -> Result<(), OutputError> {
        let Some(writer) = self.writer.take() else {
            return Ok(());
        };
        let put = writer
            .into_inner()
            .map_err(io::IntoInnerError::into_error)
            .and_then(|file| file.sync_all())
            .and_then(|()| fs::rename(&self.draft, &self.place));
        put.map_err(|source| {
            self.discard();
            file_error(&self.place, source)
        })
    }

    /// Writes the file at `place` in one go.
    ///
    /// # Errors
    /// As [`AtomicFile::create`] and [`AtomicFile::finish`], and those of `write`.
    pub fn write(place: &Path, write: impl FnOnce(&mut Self) -> io::Result<()>) -> Result<(), OutputError> {
        let mut file = Self::create(place)?;
        write(&mut file).map_err(|source| file_error(place, source))?;
        file.finish()
    }

    fn discard(&self) {
        // Nothing more can be done about a draft that cannot be removed; the error that led here is told.
        let _ = fs::remove_file(&self.draft);
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.as_mut().map_or(Ok(0), |w| w.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.as_mut().map_or(Ok(()), BufWriter::flush)
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if let Some(writer) = self.writer.take() {
            // The content is not wanted any more: drop it without flushing.
            drop(writer.into_parts());
            self.discard();
        }
    }
}

fn draft_of(place: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(place.file_name().unwrap_or_default());
    name.push(format!(".{}.draft", std::process::id()));
    place.with_file_name(name)
}

fn file_error(place: &Path, source: io::Error) -> OutputError {
    OutputError::File {
        name: place.display().to_string(),
        source,
    }
}

/// Makes the folder, with those above it, and tries whether it can be written into.
///
/// # Errors
/// It cannot be made, is a file, or is not writable.
pub fn prepare_folder(folder: &Path) -> Result<(), OutputError> {
    let probe = draft_of(&folder.join("probe"));
    fs::create_dir_all(folder)
        .and_then(|()| File::create(&probe))
        .and_then(|_| fs::remove_file(&probe))
        .map_err(|source| OutputError::Folder {
            name: folder.display().to_string(),
            source,
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_not_finished_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("map.json");
        AtomicFile::write(&place, |f| f.write_all(b"old")).unwrap();
        let mut half = AtomicFile::create(&place).unwrap();
        half.write_all(&vec![b'x'; 100_000]).unwrap();
        drop(half);
        assert_eq!(fs::read(&place).unwrap(), b"old");
        assert_eq!(
            fs::read_dir(folder.path()).unwrap().count(),
            1,
            "the draft is gone"
        );
    }

    #[test]
    fn a_folder_below_a_file_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, b"").unwrap();
        let error = prepare_folder(&file.join("out")).unwrap_err();
        assert!(
            error.to_string().starts_with("cannot write into the folder"),
            "{error}"
        );
    }
}

//! Files that are either complete or not there.
//!
//! A file is written under a temporary name in the folder of its target and renamed when it is
//! complete, so that no reader ever sees half of it and nothing is left of a failed attempt. What
//! is not a regular file (a pipe, `/dev/stdout`) is written to directly.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::NamedTempFile;

use crate::failure::Failure;

/// The temporary file being written, for [`abandon`].
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Something that can be written and sought in.
pub trait Sink: Write + Seek {}

impl<T: Write + Seek> Sink for T {}

/// Checks that a file can be written at `path`, without leaving anything there.
///
/// # Errors
/// A usage failure if the folder is missing or takes no new files, or if `path` is a folder.
pub fn probe(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::io("cannot write", path, "it is a folder"));
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        let failure = Failure::io("cannot write", path, "its folder does not exist");
        return Err(failure.with_help(format!("make it first: mkdir -p {}", folder.display())));
    }
    if is_special(path) {
        return Ok(());
    }
    temporary_in(&folder).map(drop).map_err(|error| Failure::io("cannot write", path, error))
}

/// Writes a file as a whole: what `fill` writes replaces the file at `path`, or nothing changes.
///
/// # Errors
/// A usage failure with the reason, among them what `fill` returned.
pub fn write(path: &Path, fill: impl FnOnce(&mut dyn Sink) -> io::Result<()>) -> Result<(), Failure> {
    let written = if is_special(path) { write_special(path, fill) } else { replace(path, fill) };
    written.map_err(|error| Failure::io("cannot write", path, error))
}

/// Removes the unfinished file of this process, for an exit without unwinding.
pub fn abandon() {
    // `try_lock`: the thread that holds the lock may be the one that is stuck.
    if let Ok(unfinished) = UNFINISHED.try_lock()
        && let Some(path) = &*unfinished
    {
        // Nothing is to be done about a file that cannot be removed.
        let _ = fs::remove_file(path);
    }
}

fn replace(path: &Path, fill: impl FnOnce(&mut dyn Sink) -> io::Result<()>) -> io::Result<()> {
    // Replace what a link points to, not the link.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let file = temporary_in(&folder_of(&target))?;
    set_unfinished(Some(file.path().to_owned()));
    let written = fill_and_rename(file, &target, fill);
    set_unfinished(None);
    written
}

/// The temporary file removes itself on the way out of any error.
fn fill_and_rename(
    file: NamedTempFile,
    target: &Path,
    fill: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
) -> io::Result<()> {
    let mut writer = BufWriter::new(file);
    fill(&mut writer)?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    // Some disks report that they are full only here.
    file.as_file().sync_data()?;
    file.persist(target).map(drop).map_err(|error| error.error)
}

fn write_special(path: &Path, fill: impl FnOnce(&mut dyn Sink) -> io::Result<()>) -> io::Result<()> {
    // Pipes cannot seek, so the whole is put together first.
    let mut whole = io::Cursor::new(Vec::new());
    fill(&mut whole)?;
    whole.seek(SeekFrom::Start(0))?;
    File::options().write(true).open(path)?.write_all(whole.get_ref())
}

/// Whether something stands at `path` that is neither a regular file nor a folder.
fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".vol-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // As for any new file: readable by all, less what the user's umask takes away.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder).map_err(|error| match error.raw_os_error() {
        // Without the temporary name, which nobody knows.
        Some(code) => io::Error::from_raw_os_error(code),
        None => error,
    })
}

fn set_unfinished(path: Option<PathBuf>) {
    *UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner) = path;
}

#[cfg(test)]
mod tests {
    use super::{probe, write};
    use std::fs;
    use std::io;
    use std::path::Path;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("folder");
        entries.map(|e| e.expect("entry").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_file_appears_complete() {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("a.txt");
        write(&path, |file| {
            assert!(!path.exists());
            file.write_all(b"all")
        })
        .expect("written");
        assert_eq!(fs::read(&path).expect("there"), b"all");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_failure_leaves_the_old_file() {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").expect("written");
        let failure = write(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .expect_err("fails");
        assert_eq!(failure.code(), 2);
        assert_eq!(fs::read(&path).expect("there"), b"old");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_an_error() {
        let failure = write(Path::new("/dev/full"), |file| file.write_all(&[0; 100])).expect_err("full");
        let text = format!("{failure:?}");
        assert!(text.contains("cannot write `/dev/full`: No space left"), "{text}");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_modes_are_ordinary() {
        use std::os::unix::fs::{PermissionsExt as _, symlink};
        let folder = tempfile::tempdir().expect("folder");
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, "old").expect("written");
        symlink(&real, &link).expect("linked");
        write(&link, |file| file.write_all(b"new")).expect("written");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
        assert_eq!(fs::read(&real).expect("there"), b"new");
        assert_ne!(fs::metadata(&real).expect("there").permissions().mode() & 0o400, 0);
    }

    #[test]
    fn probing_finds_what_writing_would_fail_on() {
        let folder = tempfile::tempdir().expect("folder");
        assert!(probe(&folder.path().join("a.png")).is_ok());
        assert!(names(folder.path()).is_empty());
        assert!(probe(folder.path()).is_err());
        assert!(probe(&folder.path().join("missing/a.png")).is_err());
    }
}

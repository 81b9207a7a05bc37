//! What a picture should be: some of its pixels in f64 with steps so small that half of them changes
//! nothing that matters, kept on disk.
//!
//! A file is found again by what it depends on: the compiled scene at its moment, the size
//! of the picture, how many places there are and how exact they are.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use vol_compiler::frame::{Frame, Image};
use vol_compiler::ir::text::print_module;
use vol_compiler::program::Program;

use crate::compare::relative_rms;
use crate::failure::Failure;
use crate::output::atomic;

/// Part of the key: raised whenever the integrator means something else.
const VERSION: u32 = 2;

/// Converged radiance at some places of a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Columns and rows.
    pub places: Vec<[u32; 2]>,
    /// Radiance, linear rgb.
    pub colors: Vec<[f64; 3]>,
    /// By how much the last level changed it: rms over rms.
    pub change: f64,
}

impl Reference {
    /// Computes the places of a picture at finer and finer levels, from 0 to `levels`, until one more
    /// changes them by at most `wanted`. `expose` gives the radiance at places at a level.
    ///
    /// # Errors
    /// What `expose` returns.
    pub fn converge(
        places: Vec<[u32; 2]>,
        levels: u32,
        wanted: f64,
        expose: impl Fn(&[[u32; 2]], u32) -> Result<Vec<[f64; 3]>, Failure>,
    ) -> Result<Self, Failure> {
        let mut colors = expose(&places, 0)?;
        let mut change = f64::INFINITY;
        for level in 1..=levels {
            let finer = expose(&places, level)?;
            change = error_of(&colors, &finer);
            colors = finer;
            if change <= wanted {
                break;
            }
        }
        Ok(Self { places, colors, change })
    }

    /// Error of a picture of the same scene: rms of the difference at the places over rms of the
    /// reference.
    #[must_use]
    pub fn error(&self, image: &Image) -> f64 {
        let found = self.places.iter().map(|&[x, y]| {
            let pixel = &image.pixels[y as usize * image.width as usize + x as usize];
            pixel.color.map(f64::from)
        });
        error_of(&found.collect::<Vec<_>>(), &self.colors)
    }

    /// Reads one that was kept; none if there is none that can be read.
    #[must_use]
    pub fn load(folder: &Path, key: &str) -> Option<Self> {
        let text = fs::read(file(folder, key)).ok()?;
        let found: Self = serde_json::from_slice(&text).ok()?;
        (found.places.len() == found.colors.len()).then_some(found)
    }

    /// Keeps it.
    ///
    /// # Errors
    /// A usage failure if the folder cannot be made or written.
    pub fn store(&self, folder: &Path, key: &str) -> Result<(), Failure> {
        fs::create_dir_all(folder).map_err(|error| Failure::io("cannot make", folder, error))?;
        atomic::write(&file(folder, key), |out| Ok(serde_json::to_writer(out, self)?))
    }
}

fn file(folder: &Path, key: &str) -> PathBuf {
    folder.join(format!("{key}.json"))
}

/// Name of the reference of a picture: a hash of all that it depends on.
#[must_use]
pub fn key(program: &Program, frame: &Frame, size: [u32; 2], places: usize, wanted: f64) -> String {
    let mut hash = Sha256::new();
    hash.update(print_module(&program.module));
    // Numbers are written with all their digits.
    hash.update(format!("{frame:?} {size:?} {places} {wanted} {VERSION} {}", env!("CARGO_PKG_VERSION")));
    hash.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}

/// Where references are kept if nothing else is asked for: a folder `vol` in the user's cache.
#[must_use]
pub fn default_folder() -> PathBuf {
    let from = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let cache = from("XDG_CACHE_HOME")
        .or_else(|| from("LOCALAPPDATA"))
        .or_else(|| from("HOME").map(|home| home.join(".cache")));
    cache.unwrap_or_else(std::env::temp_dir).join("vol").join("references")
}

/// Pixels spread evenly over a picture: at most `count`, none twice; all of a small picture.
#[must_use]
pub fn spread(size: [u32; 2], count: usize) -> Vec<[u32; 2]> {
    let mut places = vol_runtime_cpu::spread_pixels(size, count);
    places.sort_unstable_by_key(|&[x, y]| (y, x));
    places.dedup();
    places
}

fn error_of(found: &[[f64; 3]], right: &[[f64; 3]]) -> f64 {
    relative_rms(found.as_flattened().iter().copied().zip(right.as_flattened().iter().copied()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vol_compiler::frame::Pixel;

    #[test]
    fn places_are_apart_and_inside() {
        let places = spread([960, 540], 256);
        assert!(places.len() > 250);
        assert!(places.iter().all(|&[x, y]| x < 960 && y < 540));
        // Each quarter has its share.
        let left_top = places.iter().filter(|&&[x, y]| x < 480 && y < 270).count();
        assert!((60..=68).contains(&left_top), "{left_top}");
        assert_eq!(spread([3, 2], 256), [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]);
    }

    #[test]
    fn levels_go_on_until_nothing_changes() {
        let law = |places: &[[u32; 2]], level: u32| {
            Ok(places.iter().map(|_| [1.0 + 0.01 * 0.25f64.powi(level as i32); 3]).collect())
        };
        let reference = Reference::converge(vec![[0, 0]], 9, 1e-4, law).expect("computed");
        // Levels change by 7.5e-3, 1.9e-3, 4.7e-4, 1.2e-4, 2.9e-5.
        assert!(reference.change <= 1e-4 && reference.change > 1e-5, "{}", reference.change);
        let stopped = Reference::converge(vec![[0, 0]], 1, 1e-9, law).expect("computed");
        assert!(stopped.change > 1e-3);
    }

    #[test]
    fn error_is_relative() {
        let reference = Reference { places: vec![[0, 0], [1, 0]], colors: vec![[2.0; 3]; 2], change: 0.0 };
        let pixel = |c: f32| Pixel { color: [c; 3], ..Pixel::default() };
        let image = Image { width: 2, height: 1, pixels: vec![pixel(2.0), pixel(2.2)] };
        assert!((reference.error(&image) - 0.1 / 2f64.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn kept_references_come_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let reference =
            Reference { places: vec![[3, 4]], colors: vec![[0.1, 1.0 / 3.0, 1e-17]], change: 1e-5 };
        let below = folder.path().join("new");
        assert_eq!(Reference::load(&below, "a"), None);
        reference.store(&below, "a").expect("written");
        assert_eq!(Reference::load(&below, "a"), Some(reference));
        fs::write(below.join("b.json"), "{").expect("written");
        assert_eq!(Reference::load(&below, "b"), None, "what is broken is computed again");
    }
}

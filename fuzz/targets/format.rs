//! A text that can be read is formatted to the same scene, and formatting that changes nothing.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vol_language::fmt::{FormatError, format};
use vol_language::source::SourceFile;

fuzz_target!(|text: &str| {
    match format(&SourceFile::new("fuzz.vol", text)) {
        Ok(once) => {
            let twice = format(&SourceFile::new("fuzz.vol", once.clone())).expect("formatted text is read");
            assert_eq!(once, twice);
        }
        Err(FormatError::Syntax(_)) => {}
        Err(FormatError::Damaged) => panic!("the formatted scene would be another"),
    }
});

//! The pattern, edges against their exact area, and what adaptive sampling promises.

use super::*;

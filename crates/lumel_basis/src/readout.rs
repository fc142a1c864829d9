//! From the coefficients that bounces carry to those that users read.

use crate::Field;

/// How light is read, where bounces carry other coefficients than those that describe it best.
///
/// It is linear, so that what is read of bounces adds up to what is read of their sum.
pub trait Readout: Send + Sync {
    /// Replaces the coefficients that were carried by those to read.
    fn read(&self, field: &mut Field);
}

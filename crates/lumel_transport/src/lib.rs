//! One application of the light transport operator

//! The ray tracer of the lumel baker

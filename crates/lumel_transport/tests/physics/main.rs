//! One application of the transport operator against closed forms.

mod classic_bugs;
mod convergence;
mod directional;
mod elements;
mod emissive;
mod gather;
mod lamps;
mod patches;
mod portions;
mod shadows;
mod shots;
mod sized;
mod skies;

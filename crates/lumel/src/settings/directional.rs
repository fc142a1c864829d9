//! Which moments of the light that arrives from different directions are kept.

use super::value::choices;
use lumel_basis::Directional;

choices! {
    Directional {
        Off = "off", "Off", "irradiance alone";
        Sh1 = "sh1", "L1", "four coefficients of spherical harmonics, bands 0 and 1";
        Sh2 = "sh2", "L2", "nine coefficients, bands 0 to 2";
    }
}

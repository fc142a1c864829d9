//! Settings whose types the crates below define.

use super::value::choices;
use lumel_sample::SamplerKind;
use lumel_transport::{EmitterSampling, LightSampling};

choices! {
    SamplerKind {
        Sobol = "sobol", "Sobol (Owen)", "scrambled Sobol points: least noise, best for powers of two";
        Halton = "halton", "Halton", "shifted Halton points: good for any number";
        Stratified = "stratified", "Stratified",
            "one point in each cell of a grid; the number is rounded up to a square";
        Random = "random", "Random", "independent points: most noise";
    }
}

choices! {
    LightSampling {
        Analytic = "analytic", "Analytic",
            "closed form of the unoccluded light minus what is occluded: noise only in penumbrae";
        Area = "area", "Area", "points uniform over the light: the textbook estimator";
    }
}

choices! {
    EmitterSampling {
        Auto = "auto", "Automatic", "by shadow rays to bright triangles and texels, and by hemisphere rays, weighted together";
        Lights = "lights", "As lights", "by shadow rays alone";
        Rays = "rays", "By rays", "hemisphere rays find them: no noise if everything emits, much if little does";
        Off = "off", "Off", "not at all: only lights and sky emit";
    }
}

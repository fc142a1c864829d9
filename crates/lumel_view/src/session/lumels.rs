//! The lightmap: where its lumels lie, and their light.
//!
//! Neither is asked for: the session compares what there is with what the settings want whenever it is polled, and starts what
//! is missing. The scene is unwrapped as soon as it is open; lumels are measured once a solve is done.

use super::running::Errand;
use super::{Hand, Session};
use crate::inputs::Inputs;
use crate::layout::{Layout, LayoutKey, LightBasis};
use crate::lumel_light::LumelIllumination;
use crate::notice::Level;
use crate::solver::{Ending, Solved, Work};
use crate::task::Background;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a session has of its lightmap.
#[derive(Default)]
pub(super) struct Lightmapping {
    layout: Option<Arc<Layout>>,
    laying_out: Option<LayingOut>,
    /// The layout that could not be made.
    impossible: Option<LayoutKey>,
    light: Option<LumelIllumination>,
    /// What the light is, or is being, measured from.
    of: Option<Wanted>,
    /// What the user has stopped.
    declined: Option<Wanted>,
}

/// A layout that is being made.
struct LayingOut {
    key: LayoutKey,
    task: Background<Layout>,
    stop: Arc<AtomicBool>,
}

/// What decides the light of lumels.
#[derive(Clone)]
pub(super) struct Wanted {
    pub(super) solved: Arc<Solved>,
    pub(super) layout: Arc<Layout>,
    pub(super) denoises: bool,
}

impl PartialEq for Wanted {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.solved, &other.solved)
            && Arc::ptr_eq(&self.layout, &other.layout)
            && self.denoises == other.denoises
    }
}

impl Drop for LayingOut {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl Session {
    /// Where lumels lie, if there is to be a lightmap and this is known.
    pub fn layout(&self) -> Option<&Arc<Layout>> {
        let layout = self.lightmapping.layout.as_ref()?;
        (Some(layout.key) == self.layout_key()).then_some(layout)
    }

    /// The light on lumels as far as it is known, if it is that of the light at the vertices.
    pub fn lumel_light(&self) -> Option<&LumelIllumination> {
        let layout = self.layout()?;
        let light = self.lightmapping.light.as_ref()?;
        let of = &self.lightmapping.of.as_ref()?.solved;
        let solved = self.computed.as_ref()?.solved.as_ref()?;
        (Arc::ptr_eq(layout, &light.layout) && Arc::ptr_eq(of, solved)).then_some(light)
    }

    /// Whether there is a finished lightmap of the light that is shown.
    pub fn has_whole_lightmap(&self) -> bool {
        self.lumel_light().is_some_and(|light| light.lightmap().is_some())
    }

    /// Whether lumels are being measured.
    pub fn is_measuring_lumels(&self) -> bool {
        self.running.as_ref().is_some_and(|running| running.errand == Errand::Lumels)
    }

    /// What is wanted of a lightmap now; `None` if there is to be none.
    fn layout_key(&self) -> Option<LayoutKey> {
        let wanted = self.lumels.basis == LightBasis::Lightmap && self.document.is_some();
        let (document, count, page_size) =
            (self.document_generation, self.lumels.count, self.lumels.page_size);
        wanted.then_some(LayoutKey { document, count, page_size, mesh: self.mesh_generation })
    }

    /// Starts what is missing of the lightmap, and stops what is no longer wanted.
    pub(super) fn follow_lumels(&mut self, hand: Hand) {
        self.poll_layout();
        let wanted = self.wanted_lumels();
        if self.is_measuring_lumels() && wanted != self.lightmapping.of {
            self.stop();
        }
        if hand == Hand::Busy {
            return;
        }
        self.lay_out();
        let Some(wanted) = wanted.filter(|_| self.running.is_none()) else { return };
        if self.lightmapping.of.as_ref() != Some(&wanted)
            && self.lightmapping.declined.as_ref() != Some(&wanted)
        {
            self.measure_lumels(wanted);
        }
    }

    /// Measures lumels that the user has stopped, after all. Returns whether there are any.
    pub(super) fn resume_lumels(&mut self) -> bool {
        self.lightmapping.declined.take().is_some()
    }

    /// What lumels are to be measured from; `None` while that is not known.
    fn wanted_lumels(&self) -> Option<Wanted> {
        let layout = Arc::clone(self.layout()?);
        let computed = self.computed.as_ref().filter(|computed| computed.complete)?;
        // While light follows the hand, there will soon be other light.
        let follows = self.follows(computed) && self.changes_since(&computed.inputs).lighting();
        let settled = !(follows || self.is_light_in_motion());
        let solved = Arc::clone(computed.solved.as_ref().filter(|_| settled)?);
        Some(Wanted { solved, layout, denoises: self.lumels.denoises })
    }

    fn lay_out(&mut self) {
        let Some(key) = self.layout_key() else {
            self.lightmapping.laying_out = None;
            return;
        };
        let lightmapping = &self.lightmapping;
        if self.is_refining() {
            // There will soon be other triangles.
            return;
        }
        let is_under_way = lightmapping.laying_out.as_ref().is_some_and(|laying_out| laying_out.key == key);
        if is_under_way || self.layout().is_some() || lightmapping.impossible == Some(key) {
            return;
        }
        let Some(document) = &self.document else { return };
        let (request, open) = (document.request.clone(), Arc::clone(&document.scene));
        let (stop, pool) = (Arc::new(AtomicBool::new(false)), Arc::clone(&self.pool));
        let stopped = Arc::clone(&stop);
        let what = format!("unwrapping {}", request.title());
        let known = lightmapping.layout.clone().filter(|layout| layout.key.has_lumels_of(&key));
        let task = Background::start(what, Arc::clone(&self.wakes.event), move || {
            pool.install(|| match known {
                Some(layout) => Ok(layout.on(&open, key)),
                None => Layout::new(&request, &open, key, &stopped),
            })
        });
        self.lightmapping.laying_out = Some(LayingOut { key, task, stop });
    }

    fn poll_layout(&mut self) {
        let finished = |laying_out: &LayingOut| Some((laying_out.key, laying_out.task.poll()?));
        let Some((key, result)) = self.lightmapping.laying_out.as_ref().and_then(finished) else { return };
        self.lightmapping.laying_out = None;
        match result {
            Ok(layout) => {
                let known = self.lightmapping.layout.as_ref();
                if known.is_some_and(|known| known.key.has_lumels_of(&layout.key)) {
                    self.lightmapping.layout = Some(Arc::new(layout));
                    self.lumel_generation += 1;
                    return;
                }
                for finding in &layout.report.findings {
                    self.notices.log(Level::Warning, finding.to_string());
                }
                let n = layout.report.findings.len();
                let more = if n > 0 { format!("; {n} warnings in the log") } else { String::new() };
                self.notices.push(Level::Info, format!("Unwrapped: {}{more}", layout.summary()));
                self.lightmapping.layout = Some(Arc::new(layout));
                self.lumel_generation += 1;
            }
            Err(problem) => {
                self.lightmapping.impossible = Some(key);
                if self.layout_key() == Some(key) {
                    self.notices.push(Level::Error, format!("The scene cannot be unwrapped: {problem}"));
                }
            }
        }
    }

    pub(super) fn forget_lumels(&mut self) {
        let Lightmapping { light, of, declined, .. } = &mut self.lightmapping;
        (*light, *of, *declined) = (None, None, None);
        self.lumel_generation += 1;
    }

    /// What is being unwrapped.
    pub(super) fn unwrapping(&self) -> Option<&str> {
        self.lightmapping.laying_out.as_ref().map(|laying_out| laying_out.task.what())
    }

    fn measure_lumels(&mut self, wanted: Wanted) {
        let (Some(document), Some(computed)) = (&self.document, &self.computed) else { return };
        let task = super::solve::task(document, wanted.solved.baker.scene(), wanted.solved.baker.settings());
        let inputs: Inputs = computed.inputs.clone();
        let Wanted { solved, layout, denoises } = wanted.clone();
        self.lightmapping.light = None;
        self.lightmapping.of = Some(wanted);
        self.run(inputs, task, Work::Lumels { solved, layout, denoises }, None, Errand::Lumels);
    }

    /// Takes in light of lumels that a job has published.
    pub(super) fn take_lumels(&mut self, light: Option<LumelIllumination>) {
        if light.is_some() {
            self.lightmapping.light = light;
            self.lumel_generation += 1;
        }
    }

    pub(super) fn finish_lumels(&mut self, ending: &Ending, seconds: f64) {
        match ending {
            Ending::Done => {
                let lumels = self.lightmapping.light.as_ref().map_or(0, |l| l.layout.lumels.coverage.len());
                let lumels = crate::values::grouped(lumels);
                self.notices.push(Level::Info, format!("Measured {lumels} lumels in {seconds:.1} s"));
            }
            Ending::Stopped => {
                let of = self.lightmapping.of.take();
                if of.is_some() && of == self.wanted_lumels() {
                    // Not for other light: it was the user.
                    self.lightmapping.declined = of;
                    self.notices.push(Level::Info, "Stopped; press Enter to measure the lumels again");
                }
            }
            Ending::Failed(problem) => {
                self.lightmapping.declined = self.lightmapping.of.take();
                self.notices.push(Level::Error, format!("The lumels cannot be measured: {problem}"));
            }
        }
    }
}

//! The discrete operator of a solve.

use lumel_basis::{Basis, Field, Sampling};
use lumel_transport::{
    Control, EmitterMask, Job, Measured, PartialField, Source, Transport, TransportError, accumulate,
};

/// The discrete operator of a solve: what measures, and the basis whose nodes it measures.
#[derive(Clone, Copy)]
pub struct Operator<'a> {
    /// What measures.
    pub transport: &'a dyn Transport,
    /// The basis of what is read and of what is measured.
    pub basis: &'a dyn Basis,
    /// The nodes of a hierarchy that may have coefficients, unless all may; the others have none where they are not measured.
    pub active: Option<&'a [bool]>,
    /// What measures direct light once more, where it is read in another basis.
    pub direct: Option<DirectOperator<'a>>,
}

/// What measures direct light in another basis than that of the bounces.
#[derive(Clone, Copy)]
pub struct DirectOperator<'a> {
    /// What measures.
    pub transport: &'a dyn Transport,
    /// The basis of what is measured: [that of direct light](Basis::direct), if the basis of the bounces names one.
    pub basis: &'a dyn Basis,
}

impl<'a> Operator<'a> {
    /// An operator that measures everything in one basis.
    pub fn new(transport: &'a dyn Transport, basis: &'a dyn Basis) -> Self {
        Self { transport, basis, active: None, direct: None }
    }

    /// What measures the direct light that surfaces reflect into the first bounce, where that is not what the basis of the
    /// bounces has of it.
    pub(crate) fn reflected_direct(&self) -> Option<DirectOperator<'a>> {
        self.direct.filter(|_| self.basis.direct().is_some())
    }

    /// The elements of a job, where elements are nodes and some of them cannot be measured.
    pub(crate) fn active<'v>(&self, valid: &'v [bool]) -> Option<&'v [bool]> {
        (self.transport.shape().sampling == Sampling::Point).then_some(valid)
    }

    /// Applies it once, with the nodes that were not measured extrapolated: coefficients of its basis.
    pub(crate) fn apply(
        &self,
        job: &Job<'_>,
        control: &Control,
        progress: Option<&dyn PartialField>,
    ) -> Result<Measured, TransportError> {
        let mut measured = accumulate(self.transport, job, control, progress)?;
        self.complete(&mut measured.field, &measured.known);
        Ok(measured)
    }

    /// Gives nodes that cannot be measured the light of their neighbours.
    pub(crate) fn extrapolate(&self, field: &mut Field, known: &[bool]) {
        let is_active = |node: usize| self.active.is_none_or(|active| active[node]);
        if (0..known.len()).any(|node| is_active(node) && !known[node]) {
            self.basis.adjacency().complete(field, known);
        }
    }

    /// Makes what was measured at some nodes the light of all: the others follow their neighbours, and values become coefficients.
    pub(crate) fn complete(&self, field: &mut Field, known: &[bool]) {
        self.extrapolate(field, known);
        if let Some(hierarchy) = self.basis.hierarchy() {
            let counts = self.active.map(|active| {
                active.iter().zip(known).map(|(active, known)| active | known).collect::<Vec<bool>>()
            });
            hierarchy.analyze(field, counts.as_deref());
        }
    }
}

impl DirectOperator<'_> {
    /// Which of its nodes lie outside geometry; `None` where what is hidden is left out as it is measured.
    pub(crate) fn visible(&self, control: &Control) -> Result<Option<Vec<bool>>, TransportError> {
        match self.transport.shape().sampling {
            Sampling::Area => Ok(None),
            Sampling::Point => visible_points(self.transport, control).map(Some),
        }
    }

    /// The direct light of emitters, all or some, where nodes are [visible](Self::visible).
    pub(crate) fn measure(
        &self,
        mask: Option<&EmitterMask>,
        visible: Option<&[bool]>,
        control: &Control,
    ) -> Result<Field, TransportError> {
        let job = Job { source: Source::Emitters(mask), bounce: 0, pass: 0, active: visible };
        Ok(Operator::new(self.transport, self.basis).apply(&job, control, None)?.field)
    }
}

/// Which nodes that are measured at points lie outside geometry.
pub(crate) fn visible_points(
    transport: &dyn Transport,
    control: &Control,
) -> Result<Vec<bool>, TransportError> {
    let job = Job { source: Source::Nothing, bounce: 0, pass: 0, active: None };
    Ok(accumulate(transport, &job, control, None)?.visible().collect())
}

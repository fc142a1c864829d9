//! What light is stored on.

use super::{lumels, points};
use crate::layout::LightBasis;
use crate::session::Session;
use crate::widgets::choice;
use eframe::egui::Ui;
use lumel::{PointSpacing, Preset};

/// What one can choose.
#[derive(Clone, Copy, PartialEq)]
enum Basis {
    Vertices,
    Points,
    Lightmap,
}

impl Basis {
    const ALL: [Self; 3] = [Self::Vertices, Self::Points, Self::Lightmap];

    fn of(session: &Session) -> Self {
        match (session.lumels.basis, session.settings.point_spacing) {
            (LightBasis::Lightmap, _) => Self::Lightmap,
            (LightBasis::Vertices, PointSpacing::Off) => Self::Vertices,
            (LightBasis::Vertices, _) => Self::Points,
        }
    }

    fn name(self) -> String {
        match self {
            Self::Vertices => "Vertices",
            Self::Points => "Points",
            Self::Lightmap => "Lightmap",
        }
        .to_owned()
    }

    fn choose(self, session: &mut Session) {
        session.lumels.basis = match self {
            Self::Vertices | Self::Points => LightBasis::Vertices,
            Self::Lightmap => LightBasis::Lightmap,
        };
        let settings = &mut session.settings;
        settings.point_spacing = match self {
            Self::Points => PointSpacing::Points(Preset::default().point_budget()),
            Self::Vertices | Self::Lightmap => PointSpacing::Off,
        };
    }
}

pub(super) fn show(session: &mut Session, ui: &mut Ui) {
    let about = "Where light is stored: at the vertices; on points scattered over the surfaces, however these are cut into \
                 triangles; or after the vertices on the lumels of a lightmap, which has sharp shadows on coarse meshes";
    let before = Basis::of(session);
    let mut basis = before;
    choice(ui, "Basis", about, &mut basis, &Basis::ALL, Basis::name);
    if basis != before {
        basis.choose(session);
    }
    if basis == Basis::Lightmap {
        lumels::show(session, ui);
    }
    points::show(session, ui);
}

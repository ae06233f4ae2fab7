//! A tool at a part: the session, and a probe that lists the contacts.

use crate::error::EngineError;
use crate::hand::Hand;
use self_cell::self_cell;
use std::rc::Rc;
use touchoff::tool::Interpreted;
use touchoff::{Contact, Law, Part, Pose, Probe};
use touchoff_haptics::{Session, SessionSettings, SessionState};

/// A part and a tool that are shared with the engine.
#[derive(Debug)]
pub(crate) struct Touched {
    pub(crate) part: Rc<Part>,
    pub(crate) tool: Rc<Interpreted>,
}

/// What borrows the part and the tool.
#[derive(Debug)]
pub(crate) struct Queries<'a> {
    session: Session<'a, Interpreted>,
    probe: Probe<'a, Interpreted>,
}

self_cell!(
    /// A session with the part and the tool that it borrows.
    pub(crate) struct Touch {
        owner: Touched,
        #[covariant]
        dependent: Queries,
    }

    impl {Debug}
);

/// The depth of contact by surface of the tool.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceContact {
    pub(crate) points: usize,
    pub(crate) depth: f64,
    pub(crate) niceness: f64,
}

/// Values per contact in the list for the page.
pub(crate) const CONTACT_VALUES: usize = 10;

impl Touch {
    /// Begins a session.
    ///
    /// # Errors
    /// Fails if a setting is out of its range.
    pub(crate) fn begin(
        touched: Touched,
        settings: &SessionSettings,
        hand: &Hand,
    ) -> Result<Touch, EngineError> {
        Touch::try_new(touched, |touched| {
            let probe = Probe::new(&touched.part, &*touched.tool).with_law(Law::Gradient);
            let session = Session::new(probe.clone(), settings, hand.limits())?;
            Ok(Queries { session, probe })
        })
    }

    /// Executes one cycle.
    pub(crate) fn cycle(&mut self, hand: &mut Hand) -> Option<SessionState> {
        self.with_dependent_mut(|_, queries| queries.session.cycle(hand))
    }

    /// Lists the contacts at a pose: at most `most` of them, evenly chosen, each as its point, depth, niceness, surface,
    /// part normal and triangle; and the contact by surface, of all.
    pub(crate) fn contacts(&mut self, pose: &Pose, most: usize) -> (Vec<f32>, Vec<SurfaceContact>) {
        self.with_dependent_mut(|touched, queries| {
            use touchoff::Tool;
            let none = SurfaceContact { points: 0, depth: 0.0, niceness: f64::INFINITY };
            let mut surfaces = vec![none; touched.tool.info().surfaces.len()];
            let contacts = queries.probe.contacts(pose);
            for contact in contacts {
                let surface = &mut surfaces[contact.surface.0];
                surface.points += 1;
                surface.depth = surface.depth.max(contact.depth);
                surface.niceness = surface.niceness.min(contact.niceness);
            }
            let stride = contacts.len().div_ceil(most.max(1)).max(1);
            let listed = contacts.iter().step_by(stride).flat_map(values).collect();
            (listed, surfaces)
        })
    }

    /// Queries the probe.
    pub(crate) fn probe<R>(&mut self, query: impl FnOnce(&mut Probe<'_, Interpreted>) -> R) -> R {
        self.with_dependent_mut(|_, queries| query(&mut queries.probe))
    }
}

fn values(contact: &Contact) -> [f32; CONTACT_VALUES] {
    let [point, normal] =
        [contact.point.coords, contact.normal].map(|vector| vector.map(|c| c as f32));
    [
        point.x,
        point.y,
        point.z,
        contact.depth as f32,
        contact.niceness as f32,
        contact.surface.0 as f32,
        normal.x,
        normal.y,
        normal.z,
        contact.triangle.0 as f32,
    ]
}

//! Containment in the material: no triangle shows that a part of the tool is wholly inside, so a point of each
//! connected piece is asked for.

use crate::certify::body::owners::Owners;
use crate::certify::body::{Body, interior};
use crate::certify::part::Location;
use crate::certify::space::Point;
use crate::certify::work::Setting;
use crate::pose::Pose;
use crate::tool::Card;
use nalgebra::Vector3;

/// Where what may not be in a part is, given that no triangle of the part meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Containment {
    /// All of it is outside the part.
    Outside,
    /// A piece of it is inside; the surface of the tool that is the nearest to a point of that piece, by its
    /// place in the card's list.
    Inside(usize),
    /// The part has no inside: its mesh is not closed and consistently oriented.
    Unknown,
    /// A point lies on the part's surface as far as doubles tell, or no point was found within the budget.
    Undecided,
}

/// A point of each connected piece of a tool that may not be in a part, with the surface that is the nearest
/// to it: those for the tolerance that was asked for last.
pub(crate) struct Cores {
    /// How deep each surface may be, in the tool's unit; infinity for any depth.
    limits: Vec<f64>,
    /// `None` where the budget was spent before one was found.
    known: Option<(f64, Option<Vec<Core>>)>,
}

#[derive(Clone, Copy)]
struct Core {
    point: Point,
    surface: usize,
}

impl Cores {
    /// Of a tool whose surfaces may be as deep as `limits` says, in the tool's unit and the order of the
    /// card. Margins, below 0, are taken as 0: a surface that keeps away from the part is outside it.
    pub(crate) fn new(limits: impl IntoIterator<Item = f64>) -> Cores {
        Cores { limits: limits.into_iter().map(|limit| limit.max(0.0)).collect(), known: None }
    }

    /// Of all of a tool, which may not be in the part at all.
    pub(crate) fn whole(card: &Card) -> Cores {
        Cores::new(card.surfaces.iter().map(|_| 0.0))
    }

    /// Those of the pieces that are deeper than their limits by more than a tolerance.
    fn deeper_than(&mut self, body: &Body<'_>, card: &Card, tolerance: f64) -> Option<&[Core]> {
        if self.known.as_ref().is_none_or(|(known, _)| *known != tolerance) {
            self.known = Some((tolerance, self.find(body, card, tolerance)));
        }
        self.known.as_ref()?.1.as_deref()
    }

    fn find(&self, body: &Body<'_>, card: &Card, tolerance: f64) -> Option<Vec<Core>> {
        match body {
            Body::Profile(section) => {
                let limit = |feature: usize| self.limits[body.surface(feature)];
                let limits: Vec<f64> = (0..section.features.len()).map(limit).collect();
                let witnesses = interior::witnesses(section, &limits, tolerance).into_iter();
                let core = |witness: interior::Witness| {
                    let [d, z] = witness.place;
                    Core { point: [d, 0.0, z], surface: body.surface(witness.feature) }
                };
                Some(witnesses.map(core).collect())
            }
            Body::Field(field) => {
                // The tool is taken to be one piece; where only what is deeper counts, so is that of each region.
                let one = self.limits.iter().all(|limit| *limit == 0.0);
                let mut cores = Vec::new();
                for (index, region) in card.regions.iter().enumerate() {
                    let limit = self.limits[region.surface];
                    if limit.is_infinite() || (one && index > 0) {
                        continue;
                    }
                    let owners = Owners::of_regions(card, |other, _| one || other == index);
                    let deepest = field.deepest(&owners, limit + tolerance, 2.0)?;
                    cores.extend(deepest.map(|(point, depth)| Core {
                        point,
                        surface: body.surface(depth.feature),
                    }));
                }
                Some(cores)
            }
        }
    }
}

impl Setting<'_> {
    /// Returns where what may not be in the part is. Call only if no triangle is deeper than its surface's limit by
    /// more than `tolerance`, in the tool's unit.
    pub(crate) fn containment(
        &self,
        (card, cores): (&Card, &mut Cores),
        pose: &Pose,
        tolerance: f64,
    ) -> Containment {
        let Some(cores) = cores.deeper_than(&self.body, card, tolerance) else {
            return Containment::Undecided;
        };
        let mut found = Containment::Outside;
        for Core { point, surface } in cores {
            let point = pose.tip() + pose.rotation() * Vector3::from(*point) * self.length;
            match self.facets.locate(point) {
                Location::Inside => return Containment::Inside(*surface),
                Location::Unknown => return Containment::Unknown,
                Location::Undecided => found = Containment::Undecided,
                Location::Outside => {}
            }
        }
        found
    }

    /// Returns whether what may not be in the part is one connected piece.
    #[cfg(feature = "postures")]
    pub(crate) fn is_one_piece(&self, (card, cores): (&Card, &mut Cores), tolerance: f64) -> bool {
        cores.deeper_than(&self.body, card, tolerance).is_some_and(|cores| cores.len() == 1)
    }
}

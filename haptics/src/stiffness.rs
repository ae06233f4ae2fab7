//! A contact stiffness that suits a tool, a part and a device.
//!
//! The stiffness follows from the depth to which the device's largest force may press the tool into a plane. On the one hand that depth is
//! small against the tool and the deflection of the device, so that the hand feels the shape of the part. On the other hand it is small
//! against the thinnest place of the part, so that the tool does not come near the other side, where the points of both sides would
//! push it through.

use super::DeviceLimits;
use nalgebra::{Point3, Vector3};
use touchoff::mesh::shapes;
use touchoff::tool::Symmetry;
use touchoff::{Cloud, Law, Part, Pose, Probe, Tool, Unit};

/// The depth relative to the radius of the contact on a plane: a ball is then pressed in by an eighth of its radius at most.
const DEPTH_OF_CONTACT: f64 = 0.25;
/// The depth relative to the deflection of the device's stiffest spring: the contact is that much stiffer than the device.
const DEPTH_OF_DEVICE: f64 = 0.1;
/// The depth relative to the thinnest place of the part.
const DEPTH_OF_THICKNESS: f64 = 0.25;
/// The least depth relative to that which follows from the tool: thinner places cannot be rendered.
const MIN_THIN_DEPTH: f64 = 0.02;
/// The fraction of the thickness from which the points of the other side are as near as those of this side.
const BREAKTHROUGH_FRACTION: f64 = 0.5;

/// Number of points at which the part's thickness is searched, and of points that stand for its surface.
const SITES: usize = 500;
const MAX_SOURCES: usize = 100_000;
/// Cosine of the angle between normals (120°) from which two points are on opposite sides.
const OPPOSITE: f64 = -0.5;

/// Squares along a side of the plane, and least number of its triangles in contact.
const PLANE_DIVISIONS: u32 = 48;
const MIN_IN_CONTACT: usize = 200;
/// Largest number of times that a depth, or the side of the plane, is halved.
const MAX_HALVINGS: usize = 24;

/// The thinnest place of a part, among those that were examined.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ThinPlace {
    /// The thickness, in the part's unit.
    pub thickness: f64,
    /// A point of the surface there.
    pub point: Point3<f64>,
}

impl ThinPlace {
    /// Searches the thinnest place of a part: at some hundred points, the distance along the normal to a point on the opposite side.
    /// Returns `None` if no point has another behind it, as on an open surface.
    pub fn of(part: &Part) -> Option<ThinPlace> {
        let tree = part.tree();
        let slots: Vec<usize> = (0..tree.slots()).filter(|slot| tree.has_point(*slot)).collect();
        let stride = |count: usize| slots.len().div_ceil(count).max(1);
        let surface_point = |slot: &usize| (tree.point(*slot), Vector3::from(tree.normal(*slot)));
        let sources: Vec<_> =
            slots.iter().step_by(stride(MAX_SOURCES)).map(surface_point).collect();
        // Behind a point there is another within the distance of neighbours.
        let spacing = match tree.covering_radius() {
            Some(cover) => 2.0 * cover.radius,
            None => {
                let area: f64 = slots.iter().map(|slot| tree.weight(*slot)).sum();
                2.0 * (area / slots.len().max(1) as f64).sqrt()
            }
        };
        let reach = spacing * (stride(MAX_SOURCES) as f64).sqrt();
        let sites = slots.iter().step_by(stride(SITES)).map(surface_point);
        let thin = sites.filter_map(|(point, normal)| {
            let behind = sources.iter().filter_map(|(other, facing)| {
                let inward = point - other;
                let height = inward.dot(&normal);
                let aside = (inward - normal * height).norm();
                (height > 0.0 && aside <= reach && facing.dot(&normal) < OPPOSITE).then_some(height)
            });
            let thickness = behind.reduce(f64::min)?;
            Some(ThinPlace { thickness, point })
        });
        thin.min_by(|one, other| one.thickness.total_cmp(&other.thickness))
    }
}

/// A contact stiffness, with the depth to which the device's largest force presses the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactStiffness {
    /// Force in N per unit of a [`Wrench`](touchoff::Wrench)'s force, as [`SessionSettings::stiffness`](super::SessionSettings) has it.
    pub stiffness: f64,
    /// The depth to which the device's largest force presses the upright tool into a plane, in the part's unit; `None` if the contact
    /// carries that force at no depth.
    pub depth: Option<f64>,
    /// The radius of the contact on the plane at that depth, in the part's unit; 0 without a depth.
    pub radius: f64,
    /// The thinnest place of the part, if it has an opposite side.
    pub thin: Option<ThinPlace>,
    /// The reason for the stiffness.
    pub source: StiffnessSource,
    /// The part's unit.
    unit: Unit,
    /// The device's largest force, N.
    force: f64,
    /// The covering radius of the part's points, in its unit, if it is known.
    covering_radius: Option<f64>,
    law: Law,
}

/// The reason for a contact stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StiffnessSource {
    /// It is given.
    Given,
    /// The depth of the contact is a fraction of its radius.
    Tool,
    /// The depth of the contact is a fraction of the deflection of the device's stiffest spring.
    Device,
    /// The depth of the contact is a fraction of the part's least thickness.
    Thickness,
    /// It is 1, since the tool exerts no force under the law.
    Forceless,
}

/// The contact of a tool with a plane, at a stiffness of 1.
#[derive(Clone, Copy)]
struct PlaneContact {
    force: f64,
    radius: f64,
}

/// A tool upright on a plane, in the part's unit.
struct OnPlane<'a> {
    tool: &'a dyn Tool,
    law: Law,
    unit: Unit,
    /// The tool's size, in the part's unit.
    size: f64,
}

impl OnPlane<'_> {
    /// Returns the contact at a depth; `None` without contact.
    fn contact(&self, depth: f64) -> Option<PlaneContact> {
        let tip = Point3::new(0.0, 0.0, -depth);
        let pose = match self.tool.info().symmetry {
            Symmetry::Revolved => Pose::from_axis(tip, Vector3::z()),
            Symmetry::Solid { .. } => Pose::from_quaternion(tip, [0.0, 0.0, 0.0, 1.0]),
        };
        let pose = pose.ok()?;
        // The plane is as wide as the tool at first, and halved until enough of its triangles are in contact.
        let mut half_width = 1.1 * self.size;
        let mut found = None;
        for _ in 0..MAX_HALVINGS {
            let plane = shapes::plane(half_width, PLANE_DIVISIONS, self.unit).ok()?;
            let plane = Part::from_cloud(&Cloud::centroids(&plane));
            let wrench = Probe::new(&plane, self.tool).with_law(self.law).wrench(&pose);
            let cell = 2.0 * (half_width / f64::from(PLANE_DIVISIONS)).powi(2);
            let area = wrench.colliding as f64 * cell;
            if wrench.colliding > 0 {
                let radius = (area / std::f64::consts::PI).sqrt();
                found = Some(PlaneContact { force: wrench.force.z.max(0.0), radius });
            }
            if wrench.colliding >= MIN_IN_CONTACT {
                break;
            }
            half_width /= 2.0;
        }
        found
    }

    /// Returns the depth that follows from the tool alone.
    fn depth(&self) -> f64 {
        let mut depth = self.size / 4.0;
        for _ in 0..MAX_HALVINGS {
            let contact = self.contact(depth);
            if contact.is_some_and(|contact| depth <= DEPTH_OF_CONTACT * contact.radius) {
                return depth;
            }
            depth /= 2.0;
        }
        // The contact of a slender cone is narrow at every depth.
        self.size / 1000.0
    }

    /// Returns the depth at which a contact of some stiffness carries a force; `None` if it does at none.
    fn depth_under(&self, force: f64, stiffness: f64) -> Option<f64> {
        let carries = |depth: f64| {
            self.contact(depth).is_some_and(|contact| stiffness * contact.force >= force)
        };
        // Deeper than half of the tool, its other side pushes.
        let mut high = self.size * 0.5f64.powi(20);
        while !carries(high) {
            high *= 2.0;
            if high > self.size / 2.0 {
                return None;
            }
        }
        let mut low = high / 2.0;
        for _ in 0..10 {
            let middle = (low + high) / 2.0;
            if carries(middle) { high = middle } else { low = middle }
        }
        Some(high)
    }
}

impl ContactStiffness {
    /// Derives a stiffness from a tool, a part and a device. The device's largest force presses the tool by an eighth of a ball's radius
    /// or a quarter of the radius of a flat end, a tenth of the deflection of the device's stiffest spring, or a quarter of the part's
    /// least thickness, whichever is less.
    pub fn derived(
        part: &Part,
        tool: &dyn Tool,
        law: Law,
        limits: &DeviceLimits,
    ) -> ContactStiffness {
        let plane = ContactStiffness::plane(part, tool, law);
        let thin = ThinPlace::of(part);
        let of_device = DEPTH_OF_DEVICE * limits.force / limits.stiffness;
        let of_device = of_device * Unit::Millimetre.factor_to(part.unit());
        let (of_tool, source) = match plane.depth() {
            of_tool if of_tool <= of_device => (of_tool, StiffnessSource::Tool),
            _ => (of_device, StiffnessSource::Device),
        };
        let of_part = thin.map(|thin| DEPTH_OF_THICKNESS * thin.thickness);
        let (depth, source) = match of_part {
            Some(of_part) if of_part < of_tool => {
                (of_part.max(MIN_THIN_DEPTH * of_tool), StiffnessSource::Thickness)
            }
            _ => (of_tool, source),
        };
        let known = |stiffness, depth, radius, source| {
            let made = ContactStiffness::given(1.0, part, law, limits);
            ContactStiffness { stiffness, depth, radius, thin, source, ..made }
        };
        match plane.contact(depth).filter(|contact| contact.force > 0.0) {
            Some(PlaneContact { force, radius }) => {
                known(limits.force / force, Some(depth), radius, source)
            }
            None => known(1.0, None, 0.0, StiffnessSource::Forceless),
        }
    }

    /// Takes a given stiffness, and computes what the device's largest force does with it.
    pub fn of(
        stiffness: f64,
        part: &Part,
        tool: &dyn Tool,
        law: Law,
        limits: &DeviceLimits,
    ) -> ContactStiffness {
        let plane = ContactStiffness::plane(part, tool, law);
        let depth = plane.depth_under(limits.force, stiffness);
        let contact = depth.and_then(|depth| plane.contact(depth));
        ContactStiffness {
            depth,
            radius: contact.map_or(0.0, |contact| contact.radius),
            thin: ThinPlace::of(part),
            ..ContactStiffness::given(stiffness, part, law, limits)
        }
    }

    fn given(stiffness: f64, part: &Part, law: Law, limits: &DeviceLimits) -> ContactStiffness {
        ContactStiffness {
            stiffness,
            depth: None,
            radius: 0.0,
            thin: None,
            source: StiffnessSource::Given,
            unit: part.unit(),
            force: limits.force,
            covering_radius: part.tree().covering_radius().map(|cover| cover.radius),
            law,
        }
    }

    fn plane<'a>(part: &Part, tool: &'a dyn Tool, law: Law) -> OnPlane<'a> {
        let info = tool.info();
        let size = info.size() * info.unit.factor_to(part.unit());
        OnPlane { tool, law, unit: part.unit(), size }
    }

    /// Returns the stiffness with its unit, and the reason for it, as a sentence.
    pub fn reason(&self) -> String {
        let ContactStiffness { stiffness, unit, force, law, .. } = self;
        let value = format!("{} N/{unit}³", rounded(*stiffness));
        let pressed = match self.depth {
            Some(depth) => format!(
                "the device's {force} N press the tool {} deep into a plane",
                unit.format(depth)
            ),
            None => format!("no contact with a plane carries the device's {force} N"),
        };
        let why = match (self.source, self.thin) {
            (StiffnessSource::Given, _) => return format!("{value}, as given: {pressed}"),
            (StiffnessSource::Forceless, _) => {
                return format!("{value}, as the tool exerts no force under the law {law}");
            }
            (StiffnessSource::Thickness, Some(thin)) => format!(
                "a quarter of the part's thickness of {} at {}",
                unit.format(thin.thickness),
                unit.format_point(&thin.point)
            ),
            (StiffnessSource::Device, _) => {
                "a tenth of the deflection of the device's stiffest spring".to_owned()
            }
            _ => "a quarter of the radius of that contact at most".to_owned(),
        };
        format!("{value}, derived from tool and part: {pressed}, {why}")
    }

    /// Returns what the tool may do with this stiffness that a hand does not expect, a sentence each: break through a thin place, or slip
    /// between the points of the part.
    pub fn warnings(&self) -> Vec<String> {
        let ContactStiffness { unit, force, .. } = self;
        let mut warnings = Vec::new();
        if self.source == StiffnessSource::Forceless {
            return warnings;
        }
        let limit = self.thin.map(|thin| (thin, BREAKTHROUGH_FRACTION * thin.thickness));
        if let Some((thin, limit)) = limit
            && self.depth.is_none_or(|depth| depth > limit)
        {
            let depth = match self.depth {
                Some(depth) => format!("press the tool {} deep", unit.format(depth)),
                None => "press the tool through any contact".to_owned(),
            };
            warnings.push(format!(
                "the part is {} thin at {}, and the device's {force} N {depth}: the tool may break through there; raise `--stiffness`, \
                 or lower `--max-force`",
                unit.format(thin.thickness),
                unit.format_point(&thin.point)
            ));
        }
        if let Some(cover) = self.covering_radius
            && self.depth.is_some()
            && self.radius < cover
        {
            warnings.push(format!(
                "points of the part are up to {} from places of its surface, and the contact under the device's {force} N has a radius of \
                 {}: the tool may slip between the points; raise `--points`, or lower `--stiffness`",
                unit.format(cover),
                unit.format(self.radius)
            ));
        }
        warnings
    }
}

/// Formats a number with three significant digits.
fn rounded(value: f64) -> String {
    let digits = (2 - value.abs().log10().floor() as i32).max(0) as usize;
    format!("{value:.digits$}")
}

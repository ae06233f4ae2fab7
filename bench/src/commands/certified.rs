//! The page `certified.md`: times of certified depths, and with the feature `peers` of `parry3d`'s contact query.

use clap::Args;
use nalgebra::{Point3, Vector3};
use std::error::Error;
use std::f64::consts::PI;
use std::fmt::Write;
use std::sync::LazyLock;
use touchoff::certify::{Certifier, MotionVerdict, PoseVerdict, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::scenes::{BALL, HEIGHT, INNER, POSES, ScenePath, pose_at_gap};
use touchoff::tool::Interpreted;
use touchoff::{Interval, Mesh, Motion, Pose, SurfaceId, Tool, Unit};
use touchoff_bench::page::{Page, Section};
#[cfg(feature = "peers")]
use touchoff_bench::peers::parry_contact::ParryContact;
use touchoff_bench::race::clock::{self, Times};
use touchoff_bench::race::contender::{Answer, Contender};
use touchoff_tools::{Fig73, Fig73Exact, Flat};

/// Tolerance of certified depths, mm.
const TOLERANCE: f64 = 1e-9;
/// Depth in the scenes where many triangles are equally deep, mm.
const TIED_DEPTH: f64 = 0.1;

/// Tolerance of certified distances, and of depths along a motion, mm.
const COARSE_TOLERANCE: f64 = 1e-3;

/// Names of the methods that return no depth at a pose.
const OTHER_METHODS: [&str; 5] = [
    "touchoff clear",
    "touchoff sweep",
    "touchoff distance",
    "touchoff distance by hand",
    "touchoff motion depth",
];

/// Times certified depths and the verdicts on poses and motions, on meshes of several sizes.
#[derive(Args)]
pub(crate) struct Certified {
    /// Approximate numbers of triangles of the meshes, separated by commas.
    #[arg(long, value_name = "N,M,…", value_delimiter = ',', default_value = "2000,20000,200000")]
    triangles: Vec<usize>,
    /// Time limit of a method per row, in seconds; slower methods skip poses.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.4, value_parser = super::not_negative)]
    seconds: f64,
}

impl Certified {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        clock::pin();
        let mut body = introduction();
        for size in &self.triangles {
            for scene in Scene::ALL {
                rows(&mut body, scene, &scene.mesh(*size), self.seconds)?;
            }
        }
        rows(&mut body, Scene::Kinked, &Scene::Kinked.mesh(2), self.seconds)?;
        Ok(Some(Page {
            name: "certified",
            title: "How long proofs of depth take",
            covers: &[
                "runtime/src/bvh",
                "runtime/src/certify",
                "runtime/src/motion.rs",
                "runtime/src/pose.rs",
                "runtime/src/tool",
            ],
            sections: vec![Section { title: "", body }],
            figures: Vec::new(),
        }))
    }
}

/// A scene: a mesh, a tool and poses.
#[derive(Clone, Copy)]
pub(crate) enum Scene {
    /// The tube, with a path of [`touchoff::scenes`].
    Along(ScenePath),
    /// The ball at this distance from the tube, mm.
    Apart(f64),
    /// A flat end mill upright on a plate.
    Flat,
    /// A flat end mill with its side along a plate.
    Line,
    /// A flat end mill in a bore of its own diameter, less twice the depth.
    Bore,
    /// A tool whose body is wider than its flute by a ten thousandth of a millimetre, with its side along two triangles.
    Kinked,
}

static KINKED: LazyLock<Interpreted> = LazyLock::new(|| {
    "tool Kinked { units mm; profile { start (0, 0); line to (6, 0) as face cutting; line to (6, 10) as flute cutting;
        line to (6.0001, 40) as body; line to (0, 40) as top; } niceness cutting: 1; }"
        .parse()
        .expect("a tool")
});

impl Scene {
    const ALL: [Scene; 8] = [
        Scene::Along(ScenePath::Outside),
        Scene::Along(ScenePath::Inside),
        Scene::Along(ScenePath::Hold),
        Scene::Apart(1.0),
        Scene::Apart(0.01),
        Scene::Flat,
        Scene::Line,
        Scene::Bore,
    ];

    pub(crate) fn name(self) -> String {
        match self {
            Scene::Along(path) => path.name().to_owned(),
            Scene::Apart(gap) => format!("apart {gap}"),
            Scene::Flat => "flat".to_owned(),
            Scene::Line => "line".to_owned(),
            Scene::Bore => "bore".to_owned(),
            Scene::Kinked => "kinked".to_owned(),
        }
    }

    pub(crate) fn tool(self) -> &'static dyn Tool {
        match self {
            Scene::Along(_) | Scene::Apart(_) => &Fig73Exact,
            Scene::Flat | Scene::Line | Scene::Bore => &Flat,
            Scene::Kinked => &*KINKED,
        }
    }

    /// Returns a mesh of about this many triangles.
    pub(crate) fn mesh(self, triangles: usize) -> Mesh {
        let root = (triangles as f64).sqrt();
        let tube = |inner: f64, height: f64| {
            // The triangles of a wall come out about as wide as high.
            let sectors = (root * 0.9).round().max(3.0);
            let layers = (triangles as f64 / (4.0 * sectors) - 1.0).round().max(1.0);
            shapes::tube(
                inner,
                inner + 2.0,
                height,
                sectors as u32,
                layers as u32,
                Unit::Millimetre,
            )
        };
        match self {
            Scene::Along(_) | Scene::Apart(_) => tube(INNER, HEIGHT),
            Scene::Flat | Scene::Line | Scene::Kinked => {
                shapes::plane(30.0, (root / 2f64.sqrt()).round() as u32, Unit::Millimetre)
            }
            Scene::Bore => tube(6.0 - TIED_DEPTH, 20.0),
        }
        .expect("a shape by construction")
    }

    pub(crate) fn pose(self, k: usize, n: usize) -> Pose {
        let u = k as f64 / n as f64;
        let [x, y] = [3.0 * (2.0 * PI * u).cos(), 3.0 * (6.0 * PI * u).sin()];
        let pose_at = |tip: Point3<f64>, axis: Vector3<f64>| {
            Pose::from_axis(tip, axis).expect("a unit vector")
        };
        match self {
            Scene::Along(path) => path.pose(k, n),
            Scene::Apart(gap) => pose_at_gap(gap, k, n),
            Scene::Flat => pose_at(Point3::new(x, y, -TIED_DEPTH), Vector3::z()),
            Scene::Line | Scene::Kinked => {
                let angle = 2.0 * PI * u;
                let axis = Vector3::new(angle.cos(), angle.sin(), 0.0);
                pose_at(Point3::new(x, y, 6.0 - TIED_DEPTH), axis)
            }
            Scene::Bore => pose_at(Point3::new(0.0, 0.0, -5.0 + 10.0 * u), Vector3::z()),
        }
    }
}

/// The certified depth.
struct CertifiedDepth<'a>(Certifier<'a>);

impl Contender for CertifiedDepth<'_> {
    fn name(&self) -> &'static str {
        "touchoff"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let penetration = self.0.deepest(pose, TOLERANCE);
        let colliding = usize::from(penetration.witness.is_some());
        Answer { colliding, depth: penetration.depth.high, wrench: None }
    }
}

/// The verdict on a pose.
struct PoseCheck<'a>(Certifier<'a>);

impl Contender for PoseCheck<'_> {
    fn name(&self) -> &'static str {
        "touchoff clear"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let clear =
            matches!(self.0.check_pose(pose), PoseVerdict::Clear | PoseVerdict::SurfaceOnly);
        Answer { colliding: usize::from(!clear), depth: 0.0, wrench: None }
    }
}

/// The verdict on a motion along the wall by the radius of the ball; in half of the poses the tool also swings by a
/// tenth of a radian.
struct MotionCheck<'a>(Certifier<'a>);

impl Contender for MotionCheck<'_> {
    fn name(&self) -> &'static str {
        "touchoff sweep"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let centre = pose.tip() + BALL * pose.axis();
        let radial = Vector3::new(centre.x, centre.y, 0.0).normalize();
        let (up, tangent) = (Vector3::z(), Vector3::z().cross(&radial));
        let angle = 34.0 * centre.z;
        let displacement = BALL * (angle.cos() * up + angle.sin() * tangent);
        let tilt = if (7.0 * angle).sin() > 0.0 { 0.1 } else { 0.0 };
        let axis = (pose.axis() + tilt * displacement.normalize()).normalize();
        let to = Pose::from_axis(centre + displacement - BALL * axis, axis).expect("a unit vector");
        let motion = Motion::new(pose, &to).expect("axes that are not opposite");
        let clear = matches!(self.0.check_motion(&motion, TOLERANCE), MotionVerdict::Clear);
        Answer { colliding: usize::from(!clear), depth: 0.0, wrench: None }
    }
}

/// The distance from the part.
struct Distance<'a> {
    name: &'static str,
    certifier: Certifier<'a>,
}

impl Contender for Distance<'_> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let distance = self.certifier.clearance(pose, COARSE_TOLERANCE).distance;
        Answer { colliding: usize::from(distance.low == 0.0), depth: 0.0, wrench: None }
    }
}

/// The depths of all surfaces on a motion by 3 mm, with a turn.
struct MotionDepths<'a> {
    certifier: Certifier<'a>,
    surfaces: usize,
}

impl Contender for MotionDepths<'_> {
    fn name(&self) -> &'static str {
        "touchoff motion depth"
    }

    fn query(&mut self, pose: &Pose) -> Answer {
        let up: Vector3<f64> = Vector3::z();
        let aside = pose.axis().cross(&up);
        let axis = (pose.axis() + 0.02 * up).normalize();
        let to = Pose::from_axis(pose.tip() + 3.0 * aside, axis).expect("a unit vector");
        let motion = Motion::new(pose, &to).expect("axes that are not opposite");
        let MotionDepths { certifier, surfaces } = self;
        let found = (0..*surfaces).map(SurfaceId).filter(|surface| {
            let found = certifier.motion_depth(*surface, &motion, 0.0, COARSE_TOLERANCE);
            !found.expect("a surface").is_clear()
        });
        Answer { colliding: usize::from(found.count() > 0), depth: 0.0, wrench: None }
    }
}

/// Times the methods of a scene on a mesh, and adds one row per method.
fn rows(body: &mut String, scene: Scene, mesh: &Mesh, seconds: f64) -> std::fmt::Result {
    let bvh = TriangleBvh::new(mesh);
    let certifier = || Certifier::new(&bvh, scene.tool()).expect("a tool with a profile");
    let mut methods: Vec<Box<dyn Contender>> =
        vec![Box::new(CertifiedDepth(certifier())), Box::new(PoseCheck(certifier()))];
    if let Scene::Apart(_) = scene {
        methods.push(Box::new(MotionCheck(certifier())));
        let by_hand = Certifier::new(&bvh, &Fig73).expect("a tool that is proved");
        methods.push(Box::new(Distance { name: "touchoff distance", certifier: certifier() }));
        let name = "touchoff distance by hand";
        methods.push(Box::new(Distance { name, certifier: by_hand }));
    }
    if let Scene::Kinked = scene {
        let surfaces = scene.tool().info().surfaces.len();
        methods.push(Box::new(MotionDepths { certifier: certifier(), surfaces }));
    }
    #[cfg(feature = "peers")]
    if let Scene::Along(_) | Scene::Apart(_) = scene {
        methods.push(Box::new(ParryContact::new(mesh)));
    }
    let poses: Vec<Pose> = (0..POSES).map(|k| scene.pose(k, POSES)).collect();
    let times = clock::race(&mut methods, &poses, seconds);
    for (method, times) in methods.iter_mut().zip(&times) {
        let error = error(&mut **method, &mut certifier(), &poses);
        eprintln!("{} {} {}", scene.name(), mesh.triangles().len(), method.name());
        row(body, scene, mesh.triangles().len(), method.name(), times, error)?;
    }
    Ok(())
}

/// Returns the largest difference between a method's depths and the certified ones, mm. Returns `None` for methods
/// without a depth.
fn error(method: &mut dyn Contender, certifier: &mut Certifier<'_>, poses: &[Pose]) -> Option<f64> {
    if OTHER_METHODS.contains(&method.name()) {
        return None;
    }
    let sampled = poses.iter().step_by(poses.len() / 50);
    let errors = sampled.map(|pose| {
        let Interval { low, high } = certifier.deepest(pose, TOLERANCE).depth;
        let depth = method.query(pose).depth;
        (depth - low).abs().max((depth - high).abs())
    });
    Some(errors.fold(0.0, f64::max))
}

fn row(
    body: &mut String,
    scene: Scene,
    triangles: usize,
    method: &str,
    times: &Times,
    error: Option<f64>,
) -> std::fmt::Result {
    let time = |ns: Option<u64>| ns.map_or("-".into(), |ns| format!("{:.2}", ns as f64 / 1e3));
    let [median, p99] = [0.5, 0.99].map(|fraction| time(times.percentile(fraction)));
    writeln!(
        body,
        "| {} | {triangles} | `{method}` | {} | {:.2} | {median} | {p99} | {} | {:.2} | {:.2} | {} |",
        scene.name(),
        times.poses(),
        times.average() / 1e3,
        time(times.longest()),
        times.cpu() / 1e3,
        times.colliding(),
        error.map_or("-".into(), |error| format!("{error:.0e}")),
    )
}

fn introduction() -> String {
    format!(
        "How deep the part's triangles are in the tool. `touchoff` proves it to {TOLERANCE:e} mm (`Certifier::deepest`), with the tool of
fig. 7.3 as its profile has it on `outside`, `inside`, `hold` and `apart`, where its ball is that many mm off; `touchoff clear`
only asks whether anything touches; `touchoff sweep` whether it stays clear on a way of 1 mm, the ball's radius, along the wall, in
half of the poses swung by 0.1 rad the while; `touchoff distance` proves the distance to {COARSE_TOLERANCE} mm (`Certifier::clearance`), and `by hand`
its lower bound alone, of the tool that the thesis writes as regions, `Fig73`. In `flat`, `line` and `bore` a square end mill of 12 mm lies {TIED_DEPTH} mm deep with its end or
its side in a plate, or in a bore, where a great many triangles are as deep. In `kinked` the body of such a mill
is 0.0001 mm wider than its flute 30 mm above, and `touchoff motion depth` bounds the depth of each surface (`Certifier::motion_depth`) on a way of 3 mm
along two triangles. `parry-contact` is `parry3d`'s `contact` of a compound and
the triangle mesh, without sweeps and without a proof; of convex shapes it takes the way out of one, which in `hold` is another depth.
**In contact** is the part of the poses at which something is inside, **error** the largest distance of a depth from the proved one, in mm,
and of the proved one the width of its interval.

| scene | triangles | method | poses | avg µs | p50 | p99 | max | CPU | in contact | error |
|---|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|
"
    )
}

//! The interface to JavaScript.

use crate::error::EngineError;
use crate::surface::{Triangles, triangles};
use crate::touch::{Hand, SurfaceContact, Touch, Touched, pose_of};
use crate::{part, tool};
use serde::Serialize;
use std::rc::Rc;
use touchoff::tool::{Interpreted, Symmetry};
use touchoff::{Law, Mesh, Part, Pose, Sampling, Tool};
use touchoff_haptics::{
    ContactStiffness, Coupling, DeviceAxes, DeviceLimits, Rendering, SessionSettings, SessionState,
};
use wasm_bindgen::prelude::{JsError, wasm_bindgen};

/// Time constant of the coupling's damper, s. A tool without contact follows the hand with this delay. The longer it is, the
/// shorter are the steps of a tool that a hand far inside the part pulls at, and the thinner the walls that hold it.
const DAMPING: f64 = 0.02;
/// Contacts that are listed for drawing.
const MAX_DRAWN_CONTACTS: usize = 4000;

/// A part, a tool, and the hand that holds the tool. Load a part and a tool, then [`start`](Engine::start).
#[wasm_bindgen]
#[derive(Debug)]
pub struct Engine {
    rate: f64,
    /// Contact stiffness, N/mm³; 0 to derive it from tool and part.
    stiffness: f64,
    /// The derived stiffness of this tool and part, N per cube of the part's unit.
    derived: Option<f64>,
    mesh: Option<Rc<Mesh>>,
    part: Option<Rc<Part>>,
    tool: Option<Rc<Interpreted>>,
    triangles: Triangles,
    hand: Hand,
    touch: Option<Touch>,
    state: Option<SessionState>,
    surfaces: Vec<SurfaceContact>,
}

#[wasm_bindgen]
impl Engine {
    /// Makes an engine without a part and a tool: `rate` cycles per second, contact stiffness in N/mm³; with 0 it follows from tool and
    /// part.
    #[wasm_bindgen(constructor)]
    pub fn new(rate: f64, stiffness: f64) -> Engine {
        Engine {
            rate,
            stiffness,
            derived: None,
            mesh: None,
            part: None,
            tool: None,
            triangles: Triangles::default(),
            hand: Hand::new(Pose::default(), DeviceLimits::default()),
            touch: None,
            state: None,
            surfaces: Vec::new(),
        }
    }

    /// Lists the tools of the library: an array of file, name and title, as JSON.
    pub fn library() -> String {
        json(&tool::library())
    }

    /// Returns the text of a library tool.
    ///
    /// # Errors
    /// Fails if the library has no such file.
    #[wasm_bindgen(js_name = libraryText)]
    pub fn library_text(file: &str) -> Result<String, JsError> {
        Ok(tool::library_text(file)?)
    }

    /// Takes the mesh of a generated part, `pocket` or `tube`. [`sample_part`](Engine::sample_part) makes it touchable.
    ///
    /// # Errors
    /// Fails for another name.
    #[wasm_bindgen(js_name = generatePart)]
    pub fn generate_part(&mut self, name: &str) -> Result<(), JsError> {
        self.take_mesh(part::generate(name)?);
        Ok(())
    }

    /// Reads the mesh of a part from the bytes of an STL, PLY or OBJ file whose lengths are in `unit`.
    ///
    /// # Errors
    /// Fails if the file cannot be read.
    #[wasm_bindgen(js_name = readPart)]
    pub fn read_part(&mut self, bytes: &[u8], name: &str, unit: &str) -> Result<(), JsError> {
        self.take_mesh(part::read(bytes, name, unit)?);
        Ok(())
    }

    /// Returns the facts about the part's mesh as JSON; `null` without a part.
    #[wasm_bindgen(js_name = partFacts)]
    pub fn part_facts(&self) -> String {
        json(&self.mesh.as_deref().map(part::facts))
    }

    /// Samples points of the part, in place of earlier ones. Returns their covering radius.
    ///
    /// # Errors
    /// Fails without a part, and for a number of points that cannot be drawn.
    #[wasm_bindgen(js_name = samplePart)]
    pub fn sample_part(&mut self, points: usize) -> Result<Option<f64>, JsError> {
        Ok(self.sample(points)?)
    }

    /// Returns the corners of the part's triangles, 9 values per triangle.
    #[wasm_bindgen(js_name = partPositions)]
    pub fn part_positions(&self) -> Vec<f32> {
        self.mesh.as_deref().map(part::positions).unwrap_or_default()
    }

    /// Compiles a tool's text, and takes the tool unless the text has errors. `files` are more texts that it may mount, a
    /// JSON object from path to text. Returns the tool and the diagnostics as JSON.
    ///
    /// # Errors
    /// Fails if `files` is not such an object. Errors of the text are diagnostics.
    #[wasm_bindgen(js_name = compileTool)]
    pub fn compile_tool(&mut self, name: &str, text: &str, files: &str) -> Result<String, JsError> {
        let (compiled, tool) = tool::compiled(name, text, files)?;
        if let Some(tool) = tool {
            // The session is one of the old tool.
            self.tool = Some(Rc::new(tool));
            self.touch = None;
            self.derived = None;
            self.make_triangles();
        }
        Ok(json(&compiled))
    }

    /// Returns the corners of the tool's triangles in its frame and the part's unit, 9 values per triangle.
    #[wasm_bindgen(js_name = toolPositions)]
    pub fn tool_positions(&self) -> Vec<f32> {
        self.triangles.positions.clone()
    }

    /// Returns the normals at the corners of the tool's triangles.
    #[wasm_bindgen(js_name = toolNormals)]
    pub fn tool_normals(&self) -> Vec<f32> {
        self.triangles.normals.clone()
    }

    /// Returns the surface of each of the tool's triangles.
    #[wasm_bindgen(js_name = toolSurfaces)]
    pub fn tool_surfaces(&self) -> Vec<u32> {
        self.triangles.surfaces.clone()
    }

    /// Sets the contact stiffness, N/mm³, or 0 for one that follows from tool and part; it holds from the next
    /// [`start`](Engine::start).
    #[wasm_bindgen(js_name = setStiffness)]
    pub fn set_stiffness(&mut self, stiffness: f64) {
        self.stiffness = stiffness;
        self.touch = None;
    }

    /// Returns the contact stiffness that is derived from tool and part, N/mm³; 0 if none was needed yet.
    #[wasm_bindgen(js_name = derivedStiffness)]
    pub fn derived_stiffness(&self) -> f64 {
        let unit = self.part.as_ref().map_or(1.0, |part| part.unit().millimetres());
        self.derived.map_or(0.0, |stiffness| stiffness / unit.powi(3))
    }

    /// Begins a session with the hand at a pose: the tip, and a quaternion x, y, z, w.
    ///
    /// # Errors
    /// Fails without a part or a tool, for an invalid pose, and for a setting out of its range.
    pub fn start(&mut self, pose: &[f64]) -> Result<(), JsError> {
        Ok(self.begin(pose)?)
    }

    /// Returns whether a session runs. A new part, tool or stiffness ends it.
    #[wasm_bindgen(js_name = isRunning)]
    pub fn is_running(&self) -> bool {
        self.touch.is_some()
    }

    /// Moves the hand to a pose within `cycles` cycles, or more if that were faster than a hand.
    ///
    /// # Errors
    /// Fails for an invalid pose.
    #[wasm_bindgen(js_name = moveTo)]
    pub fn move_to(&mut self, pose: &[f64], cycles: f64) -> Result<(), JsError> {
        let pose = pose_of(pose)?;
        // Without a part the hand has no unit, and without a tool it is not known whether spin counts.
        if let Some((part, tool)) = self.part.as_ref().zip(self.tool.as_ref()) {
            let unit = part.unit().millimetres();
            self.hand.move_to(pose, cycles, tool.info().symmetry, unit);
        }
        Ok(())
    }

    /// Executes cycles. Does nothing without a session.
    pub fn step(&mut self, cycles: u32) {
        if let Some(touch) = &mut self.touch {
            for _ in 0..cycles {
                self.state = touch.cycle(&mut self.hand).or(self.state);
            }
        }
    }

    /// Returns the state after the last cycle, or an empty list before the first: cycle, tip and rotation of the tool
    /// (column by column), tip and rotation of the hand, force and torque on the hand, depth, niceness (infinite without
    /// contact), points in contact, greatest stiffness relative to the device's, and 1 if the pose was held.
    pub fn state(&self) -> Vec<f64> {
        self.state.as_ref().map(values).unwrap_or_default()
    }

    /// Returns contacts at the tool's pose, 10 values each: point, depth, niceness, surface, normal and triangle of the part. Of many, it
    /// lists some, evenly chosen.
    pub fn contacts(&mut self) -> Vec<f32> {
        match self.state {
            Some(state) => self.contacts_of(&state.tool),
            None => Vec::new(),
        }
    }

    /// Returns the state of a tool that is held at a pose, with the values of [`state`](Engine::state). Force and torque are 0, as
    /// no hand feels them.
    ///
    /// # Errors
    /// Fails for an invalid pose, and without a session.
    #[wasm_bindgen(js_name = stateAt)]
    pub fn state_at(&mut self, pose: &[f64]) -> Result<Vec<f64>, JsError> {
        Ok(self.held(pose)?)
    }

    /// Returns contacts at a pose, with the values of [`contacts`](Engine::contacts).
    ///
    /// # Errors
    /// Fails for an invalid pose.
    #[wasm_bindgen(js_name = shownContacts)]
    pub fn shown_contacts(&mut self, pose: &[f64]) -> Result<Vec<f32>, JsError> {
        Ok(self.contacts_of(&pose_of(pose)?))
    }

    /// Returns points, depth and least niceness by surface of the tool, as of the last [`contacts`](Engine::contacts).
    #[wasm_bindgen(js_name = surfaceContacts)]
    pub fn surface_contacts(&self) -> Vec<f64> {
        let surfaces = self.surfaces.iter();
        surfaces
            .flat_map(|contact| [contact.points as f64, contact.depth, contact.niceness])
            .collect()
    }

    /// Returns the wrench at a pose: points in contact, force, torque, depth, niceness, integral and energy.
    ///
    /// # Errors
    /// Fails for an invalid pose, and without a session.
    pub fn wrench(&mut self, pose: &[f64]) -> Result<Vec<f64>, JsError> {
        let pose = pose_of(pose)?;
        let wrench = self.running()?.probe(|probe| probe.wrench(&pose));
        let [force, torque] = [wrench.force, wrench.torque];
        let niceness = wrench.niceness.unwrap_or(f64::INFINITY);
        let mut values = vec![wrench.colliding as f64];
        values.extend(force.iter().chain(torque.iter()));
        values.extend([wrench.depth(), niceness, wrench.integral, wrench.energy]);
        Ok(values)
    }

    /// Returns all contacts at a pose, 16 values each: point, normal, direction and gradient, then depth, magnitude,
    /// niceness and weight.
    ///
    /// # Errors
    /// Fails for an invalid pose, and without a session.
    #[wasm_bindgen(js_name = contactsAt)]
    pub fn contacts_at(&mut self, pose: &[f64]) -> Result<Vec<f64>, JsError> {
        let pose = pose_of(pose)?;
        Ok(self.running()?.probe(|probe| {
            let mut values = Vec::new();
            for contact in probe.contacts(&pose) {
                let point = contact.point.coords;
                for vector in [point, contact.normal, contact.direction, contact.gradient] {
                    values.extend(vector.iter());
                }
                values.extend([contact.depth, contact.magnitude, contact.niceness, contact.weight]);
            }
            values
        }))
    }
}

impl Engine {
    fn take_mesh(&mut self, mesh: Mesh) {
        // Points and session are those of the old part.
        self.mesh = Some(Rc::new(mesh));
        self.part = None;
        self.touch = None;
        self.derived = None;
        self.make_triangles();
    }

    fn sample(&mut self, points: usize) -> Result<Option<f64>, EngineError> {
        let mesh = self.mesh.as_ref().ok_or(EngineError::NotLoaded)?;
        let part = Part::from_mesh(mesh, Sampling::new(points))?;
        let cover = part.tree().covering_radius().map(|cover| cover.radius);
        self.part = Some(Rc::new(part));
        self.touch = None;
        self.derived = None;
        Ok(cover)
    }

    fn make_triangles(&mut self) {
        if let Some((mesh, tool)) = self.mesh.as_ref().zip(self.tool.as_ref()) {
            let scale = tool.info().unit.factor_to(mesh.unit());
            self.triangles = triangles(&**tool, scale);
        }
    }

    fn begin(&mut self, pose: &[f64]) -> Result<(), EngineError> {
        let (Some(part), Some(tool)) = (&self.part, &self.tool) else {
            return Err(EngineError::NotLoaded);
        };
        let axes = match tool.info().symmetry {
            Symmetry::Revolved => DeviceAxes::Five,
            Symmetry::Solid { .. } => DeviceAxes::Six,
        };
        let limits = DeviceLimits { axes, ..DeviceLimits::default() };
        self.hand = Hand::new(pose_of(pose)?, limits);
        let stiffness = if self.stiffness > 0.0 {
            // From N/mm³ to N per cube of the part's unit.
            self.stiffness * part.unit().millimetres().powi(3)
        } else {
            *self.derived.get_or_insert_with(|| {
                let law = Law::default();
                ContactStiffness::derived(part, &**tool as &dyn Tool, law, &limits).stiffness
            })
        };
        let settings = SessionSettings {
            stiffness,
            rendering: Some(Rendering::Coupled(Coupling {
                damping: DAMPING,
                ..Coupling::of(&limits)
            })),
            ..SessionSettings::new(self.rate)
        };
        let touched = Touched { part: Rc::clone(part), tool: Rc::clone(tool) };
        self.touch = Some(Touch::begin(touched, &settings, &self.hand)?);
        self.state = None;
        Ok(())
    }

    fn contacts_of(&mut self, pose: &Pose) -> Vec<f32> {
        let Some(touch) = &mut self.touch else { return Vec::new() };
        let (listed, surfaces) = touch.contacts(pose, MAX_DRAWN_CONTACTS);
        self.surfaces = surfaces;
        listed
    }

    fn held(&mut self, pose: &[f64]) -> Result<Vec<f64>, EngineError> {
        let pose = pose_of(pose)?;
        let wrench = self.running()?.probe(|probe| probe.wrench(&pose));
        let mut values = vec![0.0];
        // Tool and hand are at one pose.
        for _ in 0..2 {
            values.extend(pose.tip().iter().chain(pose.rotation().iter()));
        }
        values.extend([0.0; 6]);
        values.extend([
            wrench.depth(),
            wrench.niceness.unwrap_or(f64::INFINITY),
            wrench.colliding as f64,
            0.0,
            0.0,
        ]);
        Ok(values)
    }

    fn running(&mut self) -> Result<&mut Touch, EngineError> {
        self.touch.as_mut().ok_or(EngineError::NotLoaded)
    }
}

fn values(state: &SessionState) -> Vec<f64> {
    let mut values = vec![state.cycle as f64];
    for pose in [&state.tool, &state.device] {
        values.extend(pose.tip().iter().chain(pose.rotation().iter()));
    }
    let wrench = &state.wrench_on_hand;
    values.extend(wrench.force.iter().chain(wrench.torque.iter()));
    values.extend([
        state.wrench.depth(),
        state.wrench.niceness.unwrap_or(f64::INFINITY),
        state.wrench.colliding as f64,
        state.stiffest,
        f64::from(u8::from(state.held)),
    ]);
    values
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("texts and numbers are JSON")
}

//! The tool stays outside while a hand far inside the part drags it along.

use touchoff_web::Engine;

const TIP_Z: usize = 3;
const HAND_Z: usize = 15;
const FORCE_Z: usize = 27;
const DEPTH: usize = 31;

/// Returns an engine with a ball of 1 mm radius above the plate.
fn engine(stiffness: f64) -> Engine {
    let mut engine = Engine::new(1000.0, stiffness);
    engine.generate_part("pocket").expect("a part");
    engine.sample_part(50_000).expect("its points");
    let text = Engine::library_text("d2_ball.tool").expect("a library tool");
    engine.compile_tool("d2_ball.tool", &text, "{}").expect("a tool");
    engine.start(&[-16.0, -10.0, 2.0, 0.0, 0.0, 0.0, 1.0]).expect("a session");
    engine
}

#[test]
fn a_ball_pushed_5_mm_into_a_plate_slides_on_it() {
    let mut engine = engine(4000.0);
    engine.move_to(&[-16.0, -10.0, -5.0, 0.0, 0.0, 0.0, 1.0], 50.0).expect("a pose");
    engine.step(300);
    for (x, y) in [(-16.0, 10.0), (12.0, 11.0), (16.0, -8.0), (-15.0, -12.0)] {
        engine.move_to(&[x, y, -5.0, 0.0, 0.0, 0.0, 1.0], 400.0).expect("a pose");
        for cycle in 0..500 {
            engine.step(1);
            let state = engine.state();
            assert_eq!(state[HAND_Z], -5.0);
            assert!(state[TIP_Z] > -0.06, "({x}, {y}) {cycle}: the tip is at {}", state[TIP_Z]);
            assert!(state[DEPTH] <= 0.06, "({x}, {y}) {cycle}: {} deep", state[DEPTH]);
        }
        let state = engine.state();
        assert!(state[DEPTH] <= 0.05 && state[FORCE_Z] > 4.5, "{state:?}");
    }
}

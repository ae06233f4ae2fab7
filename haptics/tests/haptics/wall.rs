//! A hand that presses a flat end onto a plane: a mass on a spring that is sampled, whose stability is the spectral
//! radius of a two by two matrix.

use touchoff_haptics::{Coupling, HandImpedance, Rendering};
use touchoff_tests::haptics::block;
use touchoff_tests::haptics::wall::{DIRECT, LIMITS, Wall, theoretical_limit};

#[test]
fn direct_rendering_is_stable_up_to_the_theoretical_stiffness() {
    let part = block(5_000);
    for rate in [500.0, 1000.0, 5000.0] {
        let limit = theoretical_limit(&HandImpedance::default(), rate);
        let [below, above] = [0.95, 1.05].map(|share| {
            Wall { part: &part, rate, rendering: DIRECT, step: 0.0 }.oscillation(share * limit)
        });
        assert!(below < 1e-3, "{rate} Hz, {limit} N/mm: {below}");
        assert!(above > 5e-3, "{rate} Hz, {limit} N/mm: {above}");
    }
}

#[test]
fn a_coupling_is_stable_for_any_wall_stiffness() {
    let part = block(5_000);
    let limit = theoretical_limit(&HandImpedance::default(), 1000.0);
    let rendering = Rendering::Coupled(Coupling::of(&LIMITS));
    let wall = Wall { part: &part, rate: 1000.0, rendering, step: 0.0 };
    for share in [1.0, 10.0, 1000.0] {
        let swing = wall.oscillation(share * limit);
        assert!(swing < 1e-3, "{share}: {swing}");
    }
}

#[test]
fn scaled_rendering_is_stable() {
    let part = block(5_000);
    let limit = theoretical_limit(&HandImpedance::default(), 1000.0);
    let rendering = Rendering::Direct { scaled: true, damping: 0.0 };
    let wall = Wall { part: &part, rate: 1000.0, rendering, step: 0.0 };
    for share in [1.05, 10.0] {
        let swing = wall.oscillation(share * limit);
        assert!(swing < 1e-3, "{share}: {swing}");
    }
}

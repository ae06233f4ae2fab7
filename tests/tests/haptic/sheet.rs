//! A sheet thinner than the tool.

use touchoff::Law;
use touchoff::haptic::Rendering;
use touchoff_tests::measure::haptics::sheet::{pressed, sheet};

#[test]
fn a_coupled_tool_stays_on_its_side() {
    let all = pressed(&sheet(), Law::Gradient, None);
    for [wanted, tip, force] in all {
        assert!(tip > -1.5, "{wanted}: {tip}");
        assert!(wanted < 4.0 || force > 0.5, "{wanted}: {force}");
    }
}

/// By the thesis's law alone the tool goes where the hand wants it.
#[test]
fn without_a_coupling_it_is_pulled_through() {
    let direct = Rendering::Direct { scaled: true, damping: 0.0 };
    let all = pressed(&sheet(), Law::Thesis, Some(direct));
    let [_, tip, _] = all.last().expect("two seconds");
    assert!(*tip < -10.0, "{tip}");
}

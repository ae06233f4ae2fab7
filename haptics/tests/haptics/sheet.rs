//! A sheet thinner than the tool.

use touchoff::Law;
use touchoff_haptics::Rendering;
use touchoff_tests::haptics::sheet::{press_on_sheet, sheet_part};

/// The tip stays on its side: it is never below the middle of the sheet, where the other surface would be nearer.
/// The hand feels its grip of 0.2 N/mm and the coupling of 1 N/mm in series, as far as it wants the tool below its
/// position.
#[test]
fn a_coupled_tool_stays_on_its_side_of_the_sheet() {
    let all = press_on_sheet(&sheet_part(), Law::Gradient, None);
    for [hand_depth, tip, force] in &all {
        assert!(*tip > -0.25, "{hand_depth}: {tip}");
        assert!(*hand_depth < 4.0 || *force > 0.6, "{hand_depth}: {force}");
    }
    let [wanted, tip, force] = all.last().expect("two seconds");
    let springs = (wanted - 0.2 + tip) * 0.2 / (0.2 + 1.0);
    assert!((force / springs - 1.0).abs() < 0.01, "{force} N of {springs}");
}

/// By the thesis's law alone the tool goes to the pose that the hand wants.
#[test]
fn without_a_coupling_the_tool_is_pulled_through_the_sheet() {
    let direct = Rendering::Direct { scaled: true, damping: 0.0 };
    let all = press_on_sheet(&sheet_part(), Law::Thesis, Some(direct));
    let [_, tip, _] = all.last().expect("two seconds");
    assert!(*tip < -10.0, "{tip}");
}

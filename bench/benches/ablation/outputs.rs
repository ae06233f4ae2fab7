//! What a question does not need: outputs, points after the first, tools of any type.

use crate::asked::{
    deepest, deepest_of, detect, detect_deepest, detect_of, listed, posture, posture_of, wrench,
    wrench_of,
};
use crate::line::{Row, Setting};
use crate::without::Thorough;
use std::hint::black_box;
use tools_library::Fig73;
use touchoff::tool::Senses;
use touchoff::{Law, Level, Probe, Tool, Weights};

/// Every question, and its answer made of the list of contacts.
pub(crate) fn of_contacts(setting: &Setting) -> Vec<Row> {
    let probe = || Probe::new(setting.part, &Fig73);
    let cutting: Vec<bool> = Fig73.card().surfaces.iter().map(|surface| surface.cutting).collect();
    let (thesis, gradient) = (Law::Thesis, Law::Gradient);
    let by_gradient = || probe().law(gradient);
    let by_unit = || probe().weights(Weights::Unit);
    vec![
        setting.compare("detect", &mut detect(probe()), &mut listed(probe(), detect_of)),
        setting.compare("deepest", &mut deepest(probe()), &mut listed(probe(), deepest_of)),
        setting.compare(
            "posture",
            &mut posture(probe()),
            &mut listed(probe(), |_, contacts| posture_of(&cutting, contacts)),
        ),
        setting.compare(
            "wrench, thesis's law",
            &mut wrench(probe()),
            &mut listed(probe(), |pose, contacts| wrench_of(thesis, pose, contacts)),
        ),
        setting.compare(
            "wrench, gradient law",
            &mut wrench(by_gradient()),
            &mut listed(by_gradient(), |pose, contacts| wrench_of(gradient, pose, contacts)),
        ),
        setting.compare(
            "wrench, unit weights",
            &mut wrench(by_unit()),
            &mut listed(by_unit(), |pose, contacts| wrench_of(thesis, pose, contacts)),
        ),
    ]
}

/// Every question, of a tool that computes everything whatever it is asked.
pub(crate) fn of_everything(setting: &Setting) -> Vec<Row> {
    let all = Thorough(&Fig73);
    let (with, without) = (Probe::new(setting.part, &Fig73), Probe::new(setting.part, &all));
    let mut rows = vec![
        setting.compare("detect", &mut detect(with.another()), &mut detect(without.another())),
        setting.compare("deepest", &mut deepest(with.another()), &mut deepest(without.another())),
        setting.compare("posture", &mut posture(with.another()), &mut posture(without.another())),
    ];
    let mut wrenches = |skip, law, weights| {
        fn of<'a, T: Senses>(probe: &Probe<'a, T>, law: Law, weights: Weights) -> Probe<'a, T> {
            probe.another().law(law).weights(weights)
        }
        let (mut with, mut without) =
            (wrench(of(&with, law, weights)), wrench(of(&without, law, weights)));
        rows.push(setting.compare(skip, &mut with, &mut without));
    };
    wrenches("wrench, thesis's law", Law::Thesis, Weights::Area);
    wrenches("wrench, gradient law", Law::Gradient, Weights::Area);
    wrenches("wrench, unit weights", Law::Thesis, Weights::Unit);
    rows
}

/// Yes or no, by a question that looks at all points.
pub(crate) fn first_hit(setting: &Setting) -> Vec<Row> {
    let probe = || Probe::new(setting.part, &Fig73);
    vec![setting.compare("detect", &mut detect(probe()), &mut detect_deepest(probe()))]
}

/// The same tool, of a type that only the run knows.
pub(crate) fn known_type(setting: &Setting) -> Vec<Row> {
    // What the compiler sees through would be no `dyn`.
    let unknown: &dyn Tool = black_box(&Fig73);
    let (with, without) = (Probe::new(setting.part, &Fig73), Probe::new(setting.part, unknown));
    vec![
        setting.compare("detect", &mut detect(with.another()), &mut detect(without.another())),
        setting.compare("wrench", &mut wrench(with), &mut wrench(without)),
    ]
}

/// The same wrench on narrower vectors.
pub(crate) fn levels(setting: &Setting) -> Vec<Row> {
    let best = Level::new();
    let narrower = narrower(best);
    let probe = |level| wrench(Probe::new(setting.part, &Fig73).level(level));
    let rows = narrower.into_iter();
    rows.map(|(name, level)| setting.compare(name, &mut probe(best), &mut probe(level))).collect()
}

/// The levels below the best.
fn narrower(best: Level) -> Vec<(&'static str, Level)> {
    let mut levels = vec![("wrench, baseline", Level::baseline())];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        let avx2 = best.as_avx512().and(best.as_avx2()).map(Level::Avx2);
        levels.extend(best.as_sse4_2().map(|level| ("wrench, SSE4.2", Level::Sse4_2(level))));
        levels.extend(avx2.map(|level| ("wrench, AVX2", level)));
    }
    levels
}

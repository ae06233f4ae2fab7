//! Time of a long program.

use std::fmt::Write as _;
use std::time::Instant;
use touchoff::gcode::{ControlSetup, Interpreter};

#[test]
fn a_million_lines() {
    let mut text = String::from("G21 G90 G17\nT1 M6\nG43.4 H1\nG0 X0. Y0. Z5. A0. C0.\nF1000.\n");
    for index in 0..1_000_000 {
        let t = 1e-3 * f64::from(index);
        let (sine, cosine) = t.sin_cos();
        let _ = match index % 10 {
            9 => writeln!(text, "G3X{:.3}Y{:.3}R200.", 50.0 * cosine, 50.0 * sine),
            _ => writeln!(
                text,
                "N{index} G1 X{:.4} Y{:.4} Z{:.4} A{:.3} C{:.3}",
                50.0 * cosine,
                50.0 * sine,
                t,
                20.0 * sine,
                t
            ),
        };
    }
    text.push_str("M30\n");
    let begin = Instant::now();
    let steps = Interpreter::new(&text, &ControlSetup::default()).expect("a program");
    let count = steps.fold(0, |count, step| count + usize::from(step.is_ok()));
    println!("{count} steps of {} MB in {:?}", text.len() / 1_000_000, begin.elapsed());
    assert_eq!(count, 1_000_001);
}

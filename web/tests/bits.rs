//! The native engine has the bits of `bits.txt`, which `bits.mjs` compares with the engine in WebAssembly.
//!
//! `UPDATE_BITS=1 cargo test -p touchoff-web --test bits` overwrites the file.

use std::fmt::Write;
use touchoff_web::Engine;

/// A linear congruential generator (Numerical Recipes, 3rd edition, 7.1.6).
struct Random(u32);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.0) / 4_294_967_296.0
    }
}

fn hex(value: f64) -> String {
    format!("{:016x}", value.to_bits())
}

/// FNV-1a over the bytes of doubles, the highest byte first.
fn digest(values: &[f64]) -> String {
    let bytes = values.iter().flat_map(|value| value.to_bits().to_be_bytes());
    let sum = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |sum, byte| {
        (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{sum:016x}")
}

#[test]
fn the_native_engine_has_the_kept_bits() {
    let mut random = Random(1);
    let mut found = String::new();
    let mut touching = 0;
    // A part with exact coordinates: those of the tube are sines, of which each platform has its own last bit.
    for file in ["d2_ball.tool", "ball_er16.tool", "fig_7_3.tool", "l_bracket.tool"] {
        let mut engine = Engine::new(1000.0, 4000.0);
        engine.generate_part("pocket").expect("a part");
        let radius = engine.sample_part(5_000).expect("points").expect("a radius");
        let text = Engine::library_text(file).expect("a library tool");
        engine.compile_tool(file, &text, "{}").expect("a tool");
        engine.start(&[0.0, 0.0, 50.0, 0.0, 0.0, 0.0, 1.0]).expect("a session");
        writeln!(found, "{file} {}", hex(radius)).expect("memory");
        for _ in 0..30 {
            let tip = [36.0, 26.0, 10.0].map(|size| size * random.next());
            let turn = [-0.5, -0.5, -0.5, 0.5].map(|from| random.next() + from);
            let [x, y, z, w] = turn;
            let norm = (x * x + y * y + z * z + w * w).sqrt();
            let [x, y, z, w] = turn.map(|value| value / norm);
            let pose = [tip[0] - 18.0, tip[1] - 13.0, tip[2] - 8.0, x, y, z, w];
            let contacts = engine.contacts_at(&pose).expect("a pose");
            let wrench = engine.wrench(&pose).expect("a pose");
            touching += usize::from(wrench[0] > 0.0);
            let wrench: Vec<String> = wrench.into_iter().map(hex).collect();
            let line = (wrench.join(" "), contacts.len() / 16, digest(&contacts));
            writeln!(found, "{} {} {}", line.0, line.1, line.2).expect("memory");
        }
    }
    assert!(touching > 80, "{touching} poses touch");
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bits.txt");
    if std::env::var_os("UPDATE_BITS").is_some() {
        std::fs::write(path, &found).expect("a writable folder");
    }
    let kept = std::fs::read_to_string(path).expect("kept bits");
    for (line, (found, kept)) in found.lines().zip(kept.lines()).enumerate() {
        assert_eq!(found, kept, "line {}", line + 1);
    }
    assert_eq!(found.lines().count(), kept.lines().count());
}

//! The output of the README's first command.

use std::process::Command;

#[test]
fn a_program_is_checked_and_the_table_has_its_rows() {
    let output = Command::new(env!("CARGO_BIN_EXE_touchoff-demo")).output().expect("it runs");
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).expect("text");
    let gouge = text
        .lines()
        .find(|line| line.starts_with("wall.nc:8: T1 flute is 0.05"))
        .expect("the gouge");
    assert!(gouge.contains("deep in the part"), "{gouge}");
    assert!(text.contains("\nFindings: "), "{text}");

    let rows: Vec<&str> =
        text.lines().filter(|line| line.contains("side ") && line.contains(" | ")).collect();
    assert_eq!(rows.len(), 8, "{text}");
    // 20,000 points, outside: the thesis has 11.8 contacts a pose on a path of the same kind.
    let contacts = rows[6].split_whitespace().nth(3).expect("the mean number of contacts");
    let contacts: f64 = contacts.parse().expect("a number");
    assert!((9.0..15.0).contains(&contacts), "{contacts}");
}

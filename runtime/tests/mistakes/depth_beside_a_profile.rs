touchoff::tool! {
    tool Pin {
        units mm;
        profile {
            start (0, 0);
            line to (3, 0), (3, 10), (0, 10) as pin cutting;
        }
        region all { depth: 3 - d; }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Pin;
}

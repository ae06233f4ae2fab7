touchoff::tool! {
    tool Groove {
        units mm;
        profile {
            start (0, 0);
            line to (5, 0) as face;
            arc to (3, 2) center (5, 2) as groove;
            line to (3, 20), (0, 20) as shank;
        }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Groove;
}

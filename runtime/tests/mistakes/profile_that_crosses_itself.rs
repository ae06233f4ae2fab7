touchoff::tool! {
    tool Pin {
        units mm;
        profile {
            start (0, 0);
            line to (4, 0), (4, 10), (1, 4), (6, 4) as pin;
            line to (6, 20), (0, 20) as shank;
        }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Pin;
}

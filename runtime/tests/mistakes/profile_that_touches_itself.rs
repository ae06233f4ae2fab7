touchoff::tool! {
    tool Pin {
        units mm;
        profile {
            start (0, 0);
            line to (4, 0), (4, 10), (2, 0), (2, 12), (0, 12) as pin;
        }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Pin;
}

touchoff::tool! {
    tool Pin {
        units mm;
        profile {
            start (0, 10);
            line to (3, 10), (3, 0), (0, 0) as pin;
        }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Pin;
}

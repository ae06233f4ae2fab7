touchoff::tool! {
    tool Pin {
        units mm;
        profile {
            start (0, 0);
            line to (3deg, 0), (3, 10), (0, 10) as pin;
        }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Pin;
}

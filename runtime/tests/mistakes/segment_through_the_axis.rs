touchoff::tool! {
    tool Pin {
        units mm;
        profile {
            start (0, 0);
            line to (3, 0), (3, 5), (-1, 7), (3, 9), (0, 10) as pin;
        }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Pin;
}

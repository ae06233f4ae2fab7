touchoff::tool! {
    tool Pin {
        units mm;
        profile {
            start (0, 0);
            line to (3, 0), (3, 10), (0, 10) as pin cutting;
        }
        region low where z <= 5 {}
        region high where z >= 6 {}
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Pin;
}

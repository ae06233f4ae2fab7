touchoff::tool! {
    tool Pin {
        units mm;
        profile {
            start (0, 0);
            line to (3, 0), (3, 10), (0, 10) as pin cutting;
        }
        niceness pni: 1 - depth/3;
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Pin;
}

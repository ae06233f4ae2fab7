touchoff::tool! {
    tool Pin {
        units mm;
        tip z = 10;
        profile {
            start (0, 0);
            line to (3, 0), (3, 10), (0, 10) as pin cutting;
        }
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Pin;
}

touchoff::tool! {
    tool Step {
        units mm;
        profile {
            start (0, 0);
            line to (3, 0), (3, 11), (5, 11), (5, 40), (0, 40) as step;
        }
        regions smooth 1.5;
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Step;
}

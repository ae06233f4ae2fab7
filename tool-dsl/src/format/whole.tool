// Every construct of the language, laid out. It is not one tool: only the layout is asked for.
tool Whole "every word" {
    units mm;
    let r = 6/2;
    param stickout = 1.5inch + 2*r - -3;
    curve cone = (z - 2)^2 - tan(3deg)*hypot(d, z)/2;
    tip z = -20;
    spindle -z;

    profile {
        start (0, 0);
        arc to (r, r) center (0, r) as ball cutting;
        arc to (r, r + 2) radius r/2 concave as relief cutting; // drawn with its radius
        line to (r, 20) as flute cutting;
        line to (12.9, 30), (14, 31.1), (14, 33.5), (16, 33.5), (16, 40), (18, 42), (18, 47.5),
            (0, 47.5) as nut;
    }

    mount "ball.tool" as cutter with D = 6, flute = 18 at z = stickout;
    mount "er16.tool" as nut at z = -stickout;

    regions nearest;
    regions smooth 1.5;

    region side where side >= 0, side <= min(low, high) { magnitude: side; }
    region IV as housing where d <= 3, 9 <= z <= 11 {
        magnitude: 14 - d - z;
        direction: toward (3, 11) allow oblique;
        niceness: 2*d^2 allow rising;
    }
    region V as housing cutting
        where 0 <= first_long_name - second_long_name <= third_long_name, back >= 0, cone <= 0,
            min(shoulder, d - 3) <= 0, parabola >= 0
    {
        depth: -cone;
        direction: away from (0, 3);
    }
    region VI {
        direction: (1, -0.5);
        /* nested /* comments */ too */
    }
    bsp { back, cone, }

    magnitude: k*depth^1.5;
    magnitude shank, nut.2: 3*k*depth;
    niceness cutting: 1 - depth/r;
    niceness nut: depth/r allow rising;
}

solid Block {
    units inch;
    region block where 0 <= x <= 1, 0 <= y <= 1, 0 <= z <= 1 {
        depth: min(x, y, z);
        direction: (0, 0, 1);
    }
}

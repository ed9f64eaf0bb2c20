//! A family of methods to why its default is taken where it is not on the front.

/// The reason, by the family's name.
pub(super) fn reason(family: &str) -> Option<&'static str> {
    Some(match family {
        "filter" => {
            "A direct form is a third faster, 3 ns a sample, and loses a digit for every half decade of f/fs; its single precision fails at 5e-4. \
             The state-variable form keeps 13 digits down to f/fs = 1e-5. The curves that are filtered have some hundred thousand \
             samples: the difference is below a millisecond."
        }
        "record ends" => {
            "Mirroring leaves the filter's own noise at the ends, as Gustafsson's method does at thrice the cost; point reflection passes the noise \
             of the end sample on and is better only on slopes steeper than some hundred times the filter's own noise a 1/f. Records end in noise. It \
             matters where a record ends within 6.2/f of what is drawn; no number of the result is taken from a filtered curve."
        }
        "integration" => {
            "On kinked pulses all rules are alike: the samples do not say where between them the kink is. On noise likewise. The corrected \
             trapezoid is the fastest of those that are accurate on smooth pulses; the spline's and the spectrum's further digits lie below any \
             sensor's."
        }
        "cut-off" => {
            "No fixed class suits casks of 1 t and of 100 t. The larger of mass and pulse does not cut the peak of the pulse, however short; it \
             leaves ringing where a cask rings below it, which the flight's fit takes off and a filter cannot. Filtered curves are only drawn."
        }
        "flight fit" => {
            "How many modes ring is not known beforehand. Any fixed number fails in another class; the most probable one is taken, at the cost of \
             fitting them all."
        }
        "reconstruction, speed" | "reconstruction, k" => {
            "Which rung suffices is not known beforehand. All four are made, at the cost of their sum, and the simplest is taken that noise and \
             tolerances explain: it is as good as the best to within the interval, where any fixed rung fails in another class."
        }
        "root of the flight" => {
            "The first root is wanted, and rivals must be told a bracket that holds it and no other. The march needs none: its steps are proved too \
             short to pass a root."
        }
        "prediction" => {
            "Which rung suffices is not known before the drop is followed; the highest holds wherever a lower one does, for microseconds. A touch of \
             the first end that would sink it less than 1 % of the length is taken for a graze, since the corner is crushed by more (9); on a rigid \
             target every touch is an impact, and there the rival that takes it for one is right."
        }
        _ => return None,
    })
}

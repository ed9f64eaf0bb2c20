//! A family of methods to why its default is taken where it is not on the front.

/// The reason, by the family's name.
pub(super) fn reason(family: &str) -> Option<&'static str> {
    Some(match family {
        "filter" => {
            "A direct form is taken for nothing: it is as fast, but it loses a digit for every half decade of f/fs and its single precision is \
             lost at 1e-4, while the state-variable form keeps all digits at every rate that a recorder has."
        }
        "record ends" => {
            "Odd reflection keeps the noise of the end sample, even reflection keeps the filter's own, but bends a slope. The program filters \
             6.2/f more on each side than it shows, so that the ends of what is filtered are not shown unless the record itself ends there; and \
             where it does, it ends on a slope more often than not."
        }
        "integration" => {
            "On kinked pulses all rules are alike: the samples do not say where between them the kink is. On noise likewise. The corrected \
             trapezoid is the fastest of those that are accurate on smooth pulses; the spline's and the spectrum's further digits lie below any \
             sensor's."
        }
        "cut-off" => {
            "No fixed class suits casks of 1 t and of 100 t. The larger of mass and pulse never cuts the peak of the pulse; it leaves ringing \
             where a cask rings below it, which the flight's fit takes off and a filter cannot. Filtered curves are only drawn."
        }
        _ => return None,
    })
}

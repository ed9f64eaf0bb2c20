//! A family of methods to why its default is taken where it is not on the front.

/// The reason, by the family's name.
pub(super) fn reason(family: &str) -> Option<&'static str> {
    Some(match family {
        "filter" => {
            "A direct form is a third faster, 3 ns a sample, and loses a digit for every half decade of f/fs; its single precision fails at 5e-4. \
             The state-variable form keeps 13 digits at every rate that a recorder has. The curves that are filtered have some hundred thousand \
             samples: the difference is below a millisecond."
        }
        "record ends" => {
            "Odd reflection passes the noise of the end sample on unfiltered; even reflection leaves the filter's own and is worse only on slopes \
             steeper than some hundred times that a 1/f. It matters where a record ends within 6.2/f of what is drawn: elsewhere the drawn curves \
             lie so far inside the filtered stretch that no continuation reaches them. No number of the result is taken from a filtered curve."
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
        _ => return None,
    })
}

"""A flight as a reader sees it: a trim held through several plannings is held once."""

from dataclasses import replace

from .log import PRIMITIVE, FlightLog, PrimitiveFlown, PrimitiveKind, primitives_flown


def stretches_flown(log: FlightLog) -> tuple[PrimitiveFlown, ...]:
    """Returns the primitives of a log; coasts in one trim that follow one another are one, empty ones none.

    A log that another program wrote has none.
    """
    if PRIMITIVE.name not in log.series:
        return ()
    stretches: list[PrimitiveFlown] = []
    for part in primitives_flown(log):
        coast = part.kind is PrimitiveKind.COAST
        if coast and part.end <= part.start:
            continue
        if coast and stretches and stretches[-1].kind is part.kind and stretches[-1].id == part.id:
            stretches[-1] = replace(stretches[-1], end=part.end)
        else:
            stretches.append(part)
    return tuple(stretches)

"""Pages that are made from the code say what the code says."""

from tools.log_contract import PAGE, page


def test_the_page_of_the_flight_log_is_the_contract() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()

"""quoted.py PAGE LOG: what a page quotes of the output of its commands is what they print.
Each line of the page's ```text blocks has to stand in LOG: the same words, numbers within 1 %. A line may end in
"..." where it goes on. Prints the lines that do not; returns how many."""
import re
import sys

TOLERANCE = 0.01
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?")


def parts(line):
    """Words with a mark for each number, and the numbers."""
    line = " ".join(line.split())
    return NUMBER.sub("#", line), [float(n) for n in NUMBER.findall(line)]


def agrees(quoted, printed):
    whole = not quoted.endswith("...")
    words, numbers = parts(quoted if whole else quoted[:-3])
    found, values = parts(printed)
    if not (found == words if whole else found.startswith(words)):
        return False
    return all(abs(a - b) <= TOLERANCE * abs(b) for a, b in zip(numbers, values))


def quotes(page):
    inside = False
    for line in page.splitlines():
        if line.startswith("```"):
            inside = line == "```text"
        elif inside and line.strip():
            yield line.strip()


def main():
    with open(sys.argv[1]) as file:
        page = file.read()
    with open(sys.argv[2]) as file:
        log = file.read().splitlines()
    missing = [q for q in quotes(page) if not any(agrees(q, line) for line in log)]
    for q in missing:
        print(f"{sys.argv[1]} quotes a line that no command prints: {q}")
    return len(missing)


if __name__ == "__main__":
    sys.exit(main())

// With a whole archive and those below it: links if nothing in it calls upward.
int main() { return 0; }
